// The naive control: nobody is warned of anything.
#pragma once

#include <limits>

#include "core/aura.h"

namespace aurasim::core {

class NoneAura final : public Aura {
 public:
  NoneAura(const AuraRules& rules, const ClearanceQuery& clearance) : Aura(rules, clearance) {}

  bool warns() const override { return false; }
  double calm_speed(bool) const override { return rules().top_speed_m_s; }
  double own_speed_of(const BodyState&) const override { return 0; }
  bool meets(const Path&, const Path&, int, int) const override { return false; }
  bool linked(const Path&, const Path&, int) const override { return false; }
  bool meets_ghost(const Path&, const Path&, int, int) const override { return false; }

 private:
  Steps steps(Question, int) const override { return {}; }
  /// Nothing is near anything.
  Range span(double) const override { return {-std::numeric_limits<double>::infinity(), 0}; }
};

}  // namespace aurasim::core
