#include "lab/aura_radius.h"

#include <memory>

#include "core/make_aura.h"
#include "lab/pair.h"

namespace aurasim::lab {
namespace {

constexpr double kUnitRadius_m = 1;

core::Path flying(double x_m, double v_m_s, double age_steps) {
  core::Path path;
  path.radius_m = kUnitRadius_m;
  path.pose.p_WB.x() = x_m;
  path.v_WB.x() = v_m_s;
  path.speed_m_s = std::abs(v_m_s);
  path.age_steps = age_steps;
  return path;
}

}  // namespace

double head_on_reach_m(AuraChoice choice, const Conditions& conditions) {
  const core::AuraRules rules = rules_for(choice, conditions);
  const RoundShapes spheres(kUnitRadius_m);
  const std::unique_ptr<const core::Aura> aura = core::make_aura(rules, spheres);
  const double v = rules.top_speed_m_s;
  double near_m = 0, far_m = 1000;
  if (choice == AuraChoice::kNone) return 0;
  while (far_m - near_m > 1e-6) {
    const double gap_m = (near_m + far_m) / 2;
    const bool meets = aura->meets(flying(gap_m + 2 * kUnitRadius_m, -v, rules.lookahead), flying(0, v, 0), 1);
    (meets ? near_m : far_m) = gap_m;
  }
  return near_m;
}

}  // namespace aurasim::lab
