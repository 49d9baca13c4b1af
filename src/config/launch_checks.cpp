#include "config/launch_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "config/launch_keys.h"
#include "core/block_owners.h"
#include "core/sphere_aura.h"

namespace aurasim::config {
namespace {

double largest_radius_m(const core::Scene& scene) {
  double radius = 0;
  for (const core::Prototype& prototype : scene.prototypes) {
    radius = std::max(radius, core::bounding_radius(scene.shapes[prototype.shape].shape));
  }
  return radius;
}

core::TightAura top_speed_aura(const Launch& launch) {
  static const core::NoShapes no_shapes;
  core::AuraRules rules;
  rules.step_s = launch.step_s();
  rules.substeps = launch.time.substeps;
  rules.looks_once = launch.physics.looks_once();
  rules.sweeps = launch.physics.is_continuous();
  rules.lookahead = launch.lookahead();
  rules.top_speed_m_s = launch.tolerances.speed_m_s;
  return {rules, no_shapes};
}

/// True for a ROS name: parts between slashes, each a letter or _, then letters, digits and _.
bool is_ros_name(const std::string& name) {
  char before = '/';
  for (const char c : name) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool is_digit = c >= '0' && c <= '9';
    if (before == '/' ? !is_letter : !is_letter && !is_digit && c != '/') return false;
    before = c;
  }
  return before != '/';
}

}  // namespace

void read_ros2(const Field& ros2, Launch& launch) {
  if (!ros2.given()) return;
  if (ros2.is_map()) {
    ros2_keys().read(ros2, launch.ros2);
    launch.ros2.on = true;
  } else if (const Word* word = ros2.word()) {
    launch.ros2.on = word->name == "on";
  }
  if (launch.ros2.on && !launch.dds.security.empty()) {
    ros2.complain("ROS 2 gets everything unencrypted, allowed: off beside dds.security");
  }
  for (const std::string& name : launch.ros2.cmd_vel) {
    if (!is_ros_name(name)) {
      ros2.complain(
          fmt::format("cmd_vel: \"{}\" is no name of a topic of ROS, allowed: letters, digits, _ and /, no "
                      "digit behind a /",
                      name));
    } else if (std::ranges::find(launch.body_sources, name, &SceneSource::name) == launch.body_sources.end()) {
      ros2.complain(fmt::format("cmd_vel: the scene has no body \"{}\"", name));
    }
  }
}

void check_statics(const Field& physics, const Launch& launch) {
  if (launch.physics.looks_once()) return;
  const auto mover = std::ranges::find_if(launch.scene.statics, &core::StaticBody::moves);
  if (mover == launch.scene.statics.end()) return;
  physics.complain(fmt::format("found the solver {} and the static \"{}\", which moves; allowed: soft_step",
                               launch.physics.solver, mover->name));
}

double reach_m(const Launch& launch) { return top_speed_aura(launch).reach(1) + 2 * largest_radius_m(launch.scene); }

// A body projects near foreign bodies wherever they are, also where pulls chain through two regions
// (docs/design.md, "The aura and its reach").
double zone_m(const Launch& launch) {
  return top_speed_aura(launch).foreign_reach(2) + 2 * largest_radius_m(launch.scene);
}

/// Checks what only coupled regions need.
void check_coupled(const Field& regions, const Launch& launch) {
  if (launch.time.sync == core::SyncMode::kFreeRunning) {
    regions.complain("exchange is coupled, allowed: aura where time.sync is free_running, because coupled nodes wait");
  }
  if (!launch.physics.looks_once()) {
    regions.complain(fmt::format("exchange is coupled, allowed: aura with the solver {}", launch.physics.solver));
  }
  try {
    core::BlockOwners(launch.regions, launch.block_m(), 0);
  } catch (const core::BadRegionMap& problem) {
    regions.complain(
        fmt::format("{}, allowed with exchange: coupled: regions at least as wide as physics.block", problem.what()));
  }
}

void check_regions(const Field& regions, std::optional<double> neighbour_distance_m, Launch& launch) {
  if (launch.lookahead() > kLargestLookahead) {
    regions.complain(fmt::format("tolerances and step_hz give a lookahead of {} steps, allowed: at most {}",
                                 launch.lookahead(), kLargestLookahead));
    return;
  }
  if (launch.time.redo == Redo::kOn && launch.time.sync == core::SyncMode::kFreeRunning) {
    regions.complain("time.redo is on, allowed: auto or off where time.sync is free_running: nodes do not agree there");
    return;
  }
  if (launch.is_coupled()) check_coupled(regions, launch);
  const double reach = reach_m(launch);
  if (launch.regions.narrowest_m() < reach && !launch.redoes() && !launch.is_coupled()) {
    regions.complain(fmt::format(
        "the narrowest region is {:.4g} m wide, allowed: at least {:.4g} m, the reach of an aura: speed {} m/s, "
        "lookahead {}, contacts looked for at {} instants of a step, largest bounding radius {:.4g} m",
        launch.regions.narrowest_m(), reach, launch.tolerances.speed_m_s, launch.lookahead(),
        top_speed_aura(launch).rules().instants(), largest_radius_m(launch.scene)));
    return;
  }
  const double zone = zone_m(launch);
  launch.neighbour_distance_is_given = neighbour_distance_m.has_value();
  launch.neighbour_distance_m = neighbour_distance_m.value_or(zone);
  if (launch.is_coupled()) launch.neighbour_distance_m = std::numeric_limits<double>::max();  // all are
  if (neighbour_distance_m && *neighbour_distance_m < zone) {
    regions.complain(
        fmt::format("neighbour_distance is {:.4g} m, allowed: at least {:.4g} m, the zone in which bodies "
                    "project",
                    *neighbour_distance_m, zone));
    return;
  }
}

}  // namespace aurasim::config
