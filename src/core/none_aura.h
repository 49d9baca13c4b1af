// The naive control without auras (NoneAura), and its variant for runs with a redo (BlindAura).
#pragma once

#include <limits>

#include "core/aura.h"

namespace aurasim::core {

class NoneAura final : public Aura {
 public:
  NoneAura(const AuraRules& rules, const ClearanceQuery& clearance) : Aura(rules, clearance) {}

  bool warns() const override { return false; }
  double speed_of(const BodyState&) const override { return rules().top_speed_m_s; }
  bool meets(const Path&, const Path&, int) const override { return false; }
  bool linked(const Path&, const Path&, int) const override { return false; }
  bool meets_ghost(const Path&, const Path&, int) const override { return false; }

 private:
  Steps steps(Question, int) const override { return {}; }
  /// Minus infinity, so no body is within any range.
  Range span(double) const override { return {-std::numeric_limits<double>::infinity(), 0}; }
};

/// The naive control where states can be computed again. Bodies that could touch foreign ones within a step or two are
/// announced, so that the check finds the pairs that touched. There is no look ahead: only bodies that touch move
/// together.
class BlindAura final : public Aura {
 public:
  BlindAura(const AuraRules& rules, const ClearanceQuery& clearance) : Aura(rules, clearance) {}

  double speed_of(const BodyState& body) const override { return body.v_WB.norm() + body.coming_kick_m_s; }
  bool meets(const Path& foreign, const Path& own, int) const override { return touch(foreign, own); }
  bool linked(const Path& a, const Path& b, int) const override { return touch(a, b); }
  bool meets_ghost(const Path& ghost, const Path& own, int) const override { return touch(ghost, own); }

 private:
  bool touch(const Path& a, const Path& b) const {
    const double margin = rules().contact_margin_m + a.blur_m + b.blur_m;
    if ((a.pose.p_WB - b.pose.p_WB).norm() > a.radius_m + b.radius_m + margin) return false;
    return clearance().clearance(a.prototype, a.pose, b.prototype, b.pose, margin) <= margin;
  }
  /// K + 2 steps: one until a state is seen, one in which the touch happens. The age of the known state is added.
  Steps steps(Question question, int) const override {
    const double k = rules().lookahead;
    return question == Question::kZone || question == Question::kNotice ? Steps{k + 2, k + 2} : Steps{0, 0};
  }
  Range span(double steps) const override {
    const double t = steps * rules().step_s;
    return {0.5 * gravity_m_s2() * t * (t + rules().step_s), t};
  }
};

}  // namespace aurasim::core
