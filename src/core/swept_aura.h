// The aura that tests the real shapes: can they touch on the predicted paths, or as far off them as each body may come
// (docs/design.md, "Swept auras")?
#pragma once

#include "core/aura.h"

namespace aurasim::core {

class SweptAura final : public Aura {
 public:
  SweptAura(const AuraRules& rules, const ClearanceQuery& clearance) : Aura(rules, clearance) {}

  bool predicts() const override { return true; }
  double speed_of(const BodyState& body) const override;
  bool meets(const Path& foreign, const Path& own, int hops) const override;
  bool linked(const Path& a, const Path& b, int hops) const override;
  bool may_approach(const Path& foreign, const Path& own, int hops) const override;
  bool meets_ghost(const Path& ghost, const Path& own, int hops) const override;

 private:
  Steps steps(Question question, int hops) const override;
  Range span(double steps) const override;
  double unfallen_m(double steps) const override { return drop_m(steps); }
  bool paths_meet(const Path& a, const Path& b, int horizon_steps) const;
  bool stay_apart(const Path& a, const Path& b, double last) const;
  double allowed_m(const Path& a, const Path& b, double steps) const;
  double drop_m(double steps) const;             ///< distance that gravity adds in `steps`
  double last_instant(int horizon_steps) const;  ///< the last instant that paths_meet() tests, in steps from now
};

}  // namespace aurasim::core
