#include "steering/command_limits.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "config/launch_variants.h"
#include "config/shapes.h"
#include "core/limits.h"
#include "cut/saved_world.h"
#include "setup/launch_setup.h"

namespace aurasim::steering {
namespace {

using namespace core::limits;

std::string problem_with_place(const core::Vec3& p, const char* what) {
  const bool sane = p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthestPlace_m;
  return sane ? std::string()
              : fmt::format("{} is too far out, allowed: {:g} m along each axis", what, kFarthestPlace_m);
}

std::string problem_with_pose(const core::Pose& pose) {
  if (!(std::abs(pose.q_WB.norm() - 1) < 1e-3)) return "its rotation is not a quaternion of length 1";
  return problem_with_place(pose.p_WB, "its place");
}

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

std::string problem_with_shape(const core::Shape& shape, bool moves, const config::Launch& launch) {
  if (const auto* mesh = std::get_if<core::TriangleMesh>(&shape)) {
    if (moves) return "a mesh of triangles cannot move; use its hull";
    if (mesh->triangles.size() > kMostTriangles) {
      return fmt::format("the mesh has {} triangles, allowed: {}", mesh->triangles.size(), kMostTriangles);
    }
  }
  const double radius_m = core::bounding_radius(shape);
  if (!(radius_m >= kSmallestRadius_m && radius_m <= kLargestRadius_m)) {
    return fmt::format("its radius is {:.4g} m, allowed: {} to {} m", radius_m, kSmallestRadius_m, kLargestRadius_m);
  }
  const double thickness_m = config::thickness_m(shape);
  if (!(thickness_m >= kThinnest_m)) {
    return fmt::format("it is {:.4g} m thin, allowed: {} m or more", thickness_m, kThinnest_m);
  }
  return moves ? problem_with_radius(radius_m, launch) : std::string();
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

std::string first_of(std::initializer_list<std::string> problems) {
  for (const std::string& problem : problems) {
    if (!problem.empty()) return problem;
  }
  return {};
}

struct Problem {
  const CommandContext& c;

  std::string operator()(const core::NewBody& ask) const {
    if (c.bodies >= kMostBodies) return fmt::format("there are {} bodies, allowed: {}", c.bodies, kMostBodies);
    const std::string where = first_of(
        {problem_with_pose(ask.pose), problem_with_speed(ask.v_WB, c.launch), problem_with_spin(ask.w_WB, c.launch)});
    if (!where.empty()) return where;
    if (!ask.shape) {
      const bool known =
          std::ranges::find(c.scene.prototypes, ask.prototype, &core::Prototype::name) != c.scene.prototypes.end();
      return known ? std::string() : fmt::format("the scene has no prototype \"{}\"", ask.prototype);
    }
    if (!(ask.mass_kg >= kLightest_kg && ask.mass_kg <= kHeaviest_kg)) {
      return fmt::format("its mass is {:.4g} kg, allowed: {} to {} kg", ask.mass_kg, kLightest_kg, kHeaviest_kg);
    }
    if (c.scene.prototypes.size() >= kMostKinds) return fmt::format("there are {} kinds of bodies already", kMostKinds);
    return c.shape ? problem_with_shape(*c.shape, true, c.launch) : "nobody knows its shape";
  }
  std::string operator()(const core::NewStatic& ask) const {
    if (c.scene.statics.size() >= kMostStatics) return fmt::format("there are {} statics already", kMostStatics);
    if (const std::string where = problem_with_pose(ask.pose); !where.empty()) return where;
    return c.shape ? problem_with_shape(*c.shape, false, c.launch) : "nobody knows its shape";
  }
  std::string operator()(const core::RemoveBody&) const { return {}; }
  std::string operator()(const core::RemoveStatic& ask) const {
    const bool known = core::value_of(ask.id) < c.scene.statics.size();
    return known ? std::string() : fmt::format("there is no static {}", core::value_of(ask.id));
  }
  /// How fast it may go is seen to once it is known where it starts (Node::complete).
  std::string operator()(const core::SendStatic& ask) const {
    if (const std::string unknown = (*this)(core::RemoveStatic{ask.id}); !unknown.empty()) return unknown;
    if (!c.launch.physics.looks_once())
      return fmt::format("the solver {} knows no statics that move", c.launch.physics.solver);
    const core::StaticBody& fixed = c.scene.statics[core::value_of(ask.id)];
    if (std::holds_alternative<core::Plane>(c.scene.shapes[fixed.shape].shape)) return "a plane cannot move";
    if (const std::string where = problem_with_pose(ask.to); !where.empty()) return where;
    if (!(ask.duration_s >= 0 && ask.duration_s <= kMostStepsAhead * c.launch.step_s())) {
      return fmt::format("a way of {:.4g} s, allowed: 0 to {:.4g} s", ask.duration_s,
                         kMostStepsAhead * c.launch.step_s());
    }
    return {};
  }
  std::string operator()(const core::Impulse& ask) const {
    if (!(ask.J_W.norm() <= kHardestImpulse_Ns)) {
      return fmt::format("an impulse of {:.4g} N s, allowed: {:g} N s", ask.J_W.norm(), kHardestImpulse_Ns);
    }
    return ask.p_W ? problem_with_place(*ask.p_W, "the point of attack") : std::string();
  }
  std::string operator()(const core::SetVelocity& ask) const {
    return first_of(
        {problem_with_speed(ask.v_WB, c.launch), ask.w_WB ? problem_with_spin(*ask.w_WB, c.launch) : std::string()});
  }
  std::string operator()(const core::SetRate& ask) const {
    if (c.launch.time.pace == config::Pace::kNone) return "this run goes as fast as it can (time.pace: none)";
    if (is_rate(ask.rate)) return {};
    return fmt::format("a rate of {:.4g}, allowed: {} to {}", ask.rate, kSlowestRate, kFastestRate);
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
  std::string operator()(const core::Ray& ask) const { return problem_with(ask); }
  std::string operator()(const core::Save& ask) const {
    const char* const problem = cut::problem_with_save_name(ask.file);
    return problem != nullptr ? problem : "";
  }
  std::string operator()(const core::Load& ask) const { return (*this)(core::Save{ask.file}); }
};

}  // namespace

std::string problem_with(const core::Command& command, const CommandContext& context) {
  if (command.at_step > context.now + kMostStepsAhead) {
    return fmt::format("state {} is more than {} ahead", command.at_step, kMostStepsAhead);
  }
  return std::visit(Problem{context}, command.ask);
}

std::string problem_with(const core::Ray& ray) {
  std::string problem = problem_with_place(ray.from_W, "the beginning of the ray");
  return problem.empty() ? problem_with_place(ray.to_W, "its end") : problem;
}

}  // namespace aurasim::steering
