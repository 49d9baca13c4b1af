#include "steering/command_limits.h"

#include <algorithm>

#include <fmt/format.h>

#include "config/launch_variants.h"
#include "core/limits.h"
#include "cut/saved_world.h"
#include "setup/launch_setup.h"
#include "steering/ask.h"

namespace aurasim::steering {
namespace {

using namespace core::limits;

std::string problem_with_speed(const core::Vec3& v, const config::Launch& launch) {
  const double limit_m_s = launch.tolerances.speed_m_s;
  if (v.norm() <= limit_m_s) return {};
  return fmt::format("{:.4g} m/s is faster than this run promises: tolerances.speed is {:.4g} m/s", v.norm(),
                     limit_m_s);
}

std::string problem_with_spin(const core::Vec3& w, const config::Launch& launch) {
  const double limit_rad_s = fastest_spin_rad_s(launch.step_s() / launch.time.substeps);
  if (w.norm() <= limit_rad_s) return {};
  return fmt::format("{:.4g} rad/s is more than a quarter turn in a substep of this run, allowed: {:.4g} rad/s",
                     w.norm(), limit_rad_s);
}

/// A body larger than any other reaches regions that do not listen to each other.
std::string problem_with_radius(double radius_m, const config::Launch& launch) {
  const double now_m = setup::listening_distance_m(launch);
  double known_m = 0;
  for (const core::Prototype& prototype : launch.scene.prototypes) {
    known_m = std::max(known_m, core::bounding_radius(launch.scene.shapes[prototype.shape].shape));
  }
  const double needed_m = now_m + 2 * std::max(0.0, radius_m - known_m);
  for (std::uint32_t r = 0; r < launch.regions.size(); ++r) {
    const core::RegionId region{r};
    if (launch.regions.neighbours(region, needed_m) == launch.regions.neighbours(region, now_m)) continue;
    return fmt::format("a body with a radius of {:.4g} m is too large for these regions; the scene's largest: {:.4g} m",
                       radius_m, known_m);
  }
  return {};
}

std::string problem_with_known_shape(const std::optional<core::Shape>& shape, bool is_body,
                                     const config::Launch& launch) {
  if (!shape) return "no node knows its shape";
  std::string why = problem_with_shape(*shape, is_body);
  if (!why.empty() || !is_body) return why;
  return problem_with_radius(core::bounding_radius(*shape), launch);
}

template <class Change>
std::string problem_with_change(Change&& change) {
  try {
    change();
  } catch (const config::BadConfig& error) {
    return error.errors().empty() ? std::string(error.what()) : error.errors().front();
  }
  return {};
}

std::string first_problem_of(std::initializer_list<std::string> problems) {
  for (const std::string& problem : problems) {
    if (!problem.empty()) return problem;
  }
  return {};
}

/// Reason why this run, in its present state, refuses an ask that is sound in itself.
struct ProblemOfRun {
  const CommandContext& c;

  std::string operator()(const core::NewBody& ask) const {
    if (c.bodies >= kMostBodies) return fmt::format("there are {} bodies, allowed: {}", c.bodies, kMostBodies);
    const std::string where =
        first_problem_of({problem_with_speed(ask.v_WB, c.launch), problem_with_spin(ask.w_WB, c.launch)});
    if (!where.empty()) return where;
    if (!ask.shape) {
      const bool known =
          std::ranges::find(c.scene.prototypes, ask.prototype, &core::Prototype::name) != c.scene.prototypes.end();
      return known ? std::string() : fmt::format("the scene has no prototype \"{}\"", ask.prototype);
    }
    if (c.scene.prototypes.size() >= kMostKinds) return fmt::format("there are {} kinds of bodies already", kMostKinds);
    return problem_with_known_shape(c.shape, true, c.launch);
  }
  std::string operator()(const core::NewStatic&) const {
    if (c.scene.statics.size() >= kMostStatics) return fmt::format("there are {} statics already", kMostStatics);
    return problem_with_known_shape(c.shape, false, c.launch);
  }
  std::string operator()(const core::RemoveStatic& ask) const {
    const bool known = core::value_of(ask.id) < c.scene.statics.size();
    return known ? std::string() : fmt::format("there is no static {}", core::value_of(ask.id));
  }
  /// How fast it may go is seen to once it is known where it starts (Node::complete).
  std::string operator()(const core::SendStatic& ask) const {
    if (const std::string unknown = (*this)(core::RemoveStatic{ask.id}); !unknown.empty()) return unknown;
    if (!c.launch.physics.looks_once())
      return fmt::format("the solver {} cannot move statics", c.launch.physics.solver);
    const core::StaticBody& fixed = c.scene.statics[core::value_of(ask.id)];
    if (std::holds_alternative<core::Plane>(c.scene.shapes[fixed.shape].shape)) return "a plane cannot move";
    const double longest_s = kMostStepsAhead * c.launch.step_s();
    if (ask.duration_s <= longest_s) return {};
    return fmt::format("found a duration of {:.4g} s, allowed: 0 to {:.4g} s", ask.duration_s, longest_s);
  }
  std::string operator()(const core::SetVelocity& ask) const {
    return first_problem_of(
        {problem_with_speed(ask.v_WB, c.launch), ask.w_WB ? problem_with_spin(*ask.w_WB, c.launch) : std::string()});
  }
  std::string operator()(const core::SetRate&) const {
    const bool has_pace = c.launch.time.pace != config::Pace::kNone;
    return has_pace ? "" : "this run goes as fast as it can (time.pace: none)";
  }
  std::string operator()(const core::Repartition& ask) const {
    if (ask.boxes.size() != c.launch.regions.size()) {
      return fmt::format("{} regions for {} nodes: there has to be one for each", ask.boxes.size(),
                         c.launch.regions.size());
    }
    return problem_with_change([&] { config::with_regions(c.launch, ask.boxes); });
  }
  std::string operator()(const core::ChangeScene& ask) const {
    return problem_with_change([&] { config::with_scene(c.launch, ask.name); });
  }
  template <class Other>
  std::string operator()(const Other&) const {
    return {};
  }
};

}  // namespace

std::string problem_with(const core::Command& command, const CommandContext& context) {
  if (command.at_step > context.now + kMostStepsAhead) {
    return fmt::format("state {} is more than {} ahead", command.at_step, kMostStepsAhead);
  }
  if (std::string why = problem_with(command.ask); !why.empty()) return why;
  return std::visit(ProblemOfRun{context}, command.ask);
}

}  // namespace aurasim::steering
