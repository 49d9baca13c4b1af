// Auras that rely only on one top speed V: bounding spheres, and a table of distances in units of V T_P.
#pragma once

#include "core/aura.h"

namespace aurasim::core {

class SphereAura : public Aura {
 public:
  double speed_of(const BodyState&) const override { return rules().top_speed_m_s; }
  bool meets(const Path& foreign, const Path& own, int hops) const override;
  bool linked(const Path& a, const Path& b, int hops) const override;
  bool meets_ghost(const Path& ghost, const Path& own, int hops) const override;

  /// The distances of the table in docs/design.md, beyond the bounding spheres and the contact margin, in metres.
  double reach(int hops) const { return way_m(meeting_steps(hops)); }
  double foreign_reach(int hops) const { return way_m(notice_steps(hops)); }
  double cluster_reach(int hops) const { return way_m(link_steps(hops)); }

 protected:
  using Aura::Aura;

  virtual Steps meeting_steps(int hops) const = 0;
  virtual Steps notice_steps(int hops) const = 0;
  virtual Steps link_steps(int hops) const = 0;

 private:
  Steps steps(Question question, int hops) const final;
  Range span(double steps) const final;
  double way_m(const Steps& steps) const { return span(steps.own).fixed_m + span(steps.other).fixed_m; }
  bool spheres_within(const Path& a, const Path& b, double distance_m) const;
};

/// The bound for frames that are aligned.
class TightAura final : public SphereAura {
 public:
  TightAura(const AuraRules& rules, const ClearanceQuery& clearance) : SphereAura(rules, clearance) {}

 private:
  Steps meeting_steps(int hops) const override;
  Steps notice_steps(int hops) const override;
  Steps link_steps(int hops) const override;
  Steps chained(double own, double other, int hops) const;
};

/// Eq. 3.4 of A. Brown's thesis, for everything: (3K' - 1) V T_P, where K' = ceil((2 T_F + T_L) / T_P).
class ThesisAura final : public SphereAura {
 public:
  ThesisAura(const AuraRules& rules, const ClearanceQuery& clearance) : SphereAura(rules, clearance) {}

 private:
  Steps meeting_steps(int) const override;
  Steps notice_steps(int hops) const override { return meeting_steps(hops); }
  Steps link_steps(int hops) const override { return meeting_steps(hops); }
};

}  // namespace aurasim::core
