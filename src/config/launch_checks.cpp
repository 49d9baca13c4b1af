#include "config/launch_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

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
                               launch.physics.solver, (*mover).name));
}

double reach_m(const Launch& launch) { return top_speed_aura(launch).reach(1) + 2 * largest_radius_m(launch.scene); }

// A body projects near foreign bodies wherever they are, also where pulls chain through two regions
// (docs/design.md, "The aura and its reach").
double zone_m(const Launch& launch) {
  return top_speed_aura(launch).foreign_reach(2) + 2 * largest_radius_m(launch.scene);
}

namespace {

struct ProblemOfCoupled {
  std::string why;      ///< why regions cannot be coupled
  std::string allowed;  ///< instead
};

std::vector<ProblemOfCoupled> problems_of_coupled(const Launch& launch) {
  std::vector<ProblemOfCoupled> problems;
  if (launch.time.sync == core::SyncMode::kFreeRunning) {
    problems.push_back({"time.sync is free_running, where nodes do not wait for each other", "exchange: aura"});
  }
  if (!launch.physics.looks_once()) {
    problems.push_back({fmt::format("the solver is {}", launch.physics.solver), "exchange: aura, or soft_step"});
  }
  try {
    core::BlockOwners(launch.regions, launch.block_m(), 0);
  } catch (const core::BadRegionMap& problem) {
    problems.push_back({problem.what(), "regions at least as wide as physics.block"});
  }
  return problems;
}

/// Why this launch cannot run with auras, and what is allowed; empty: it can.
std::string problem_of_auras(const Launch& launch) {
  if (launch.lookahead() > kLargestLookahead) {
    return fmt::format("tolerances and step_hz give a lookahead of {} steps, allowed: at most {}", launch.lookahead(),
                       kLargestLookahead);
  }
  const double reach = reach_m(launch);
  if (launch.regions.narrowest_m() >= reach || launch.redoes()) return {};
  return fmt::format(
      "the narrowest region is {:.4g} m wide, allowed: at least {:.4g} m, the reach of an aura: speed {} m/s, "
      "lookahead {}, contacts looked for at {} instants of a step, largest bounding radius {:.4g} m",
      launch.regions.narrowest_m(), reach, launch.tolerances.speed_m_s, launch.lookahead(),
      top_speed_aura(launch).rules().instants(), largest_radius_m(launch.scene));
}

/// The more processes share the cores, the more the several exchanges of a step cost. In a world without heaps a step
/// of 36 coupled nodes on two cores takes 1.2 times what it takes with auras, and one of 64 nodes twice
/// (docs/decisions/0050-coupled-where-near.md).
constexpr std::size_t kMostCoupledByAuto = 36;

/// Where `exchange: auto` can mean only one of the two, no node has to measure anything.
void settle_auto(Launch& launch) {
  if (launch.exchange != Exchange::kAuto) return;
  if (launch.regions.size() == 1) {
    launch.exchange = Exchange::kAura;
    launch.why_exchange = "there is one region";
  } else if (const std::string problem_of_coupled = why_not_coupled(launch); !problem_of_coupled.empty()) {
    launch.exchange = Exchange::kAura;
    launch.why_exchange = problem_of_coupled;
  } else if (const std::string problem = problem_of_auras(launch); !problem.empty()) {
    launch.exchange = Exchange::kCoupled;
    launch.why_exchange = problem;
  } else if (launch.regions.size() > kMostCoupledByAuto) {
    launch.exchange = Exchange::kAura;
    launch.why_exchange = fmt::format(
        "there are {} regions, more than the {} that it couples, as each step waits for all of them several times",
        launch.regions.size(), kMostCoupledByAuto);
  }
}

}  // namespace

bool is_on_loopback(const Dds& dds) {
  return std::ranges::all_of(dds.interfaces, [](const std::string& address) { return address.starts_with("127."); });
}

std::string why_not_coupled(const Launch& launch) {
  const std::vector<ProblemOfCoupled> problems = problems_of_coupled(launch);
  return problems.empty() ? std::string() : problems.front().why;
}

void check_regions(const Field& regions, std::optional<double> neighbour_distance_m, Launch& launch) {
  settle_auto(launch);
  if (launch.time.redo == Redo::kOn && launch.time.sync == core::SyncMode::kFreeRunning) {
    regions.complain("time.redo is on, allowed: auto or off where time.sync is free_running: nodes do not agree there");
    return;
  }
  if (launch.is_coupled()) {
    for (const auto& [why, allowed] : problems_of_coupled(launch)) {
      regions.complain(fmt::format("exchange is coupled, and {}; allowed: {}", why, allowed));
    }
  } else if (const std::string problem = problem_of_auras(launch); !problem.empty()) {
    regions.complain(problem);
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
  }
}

}  // namespace aurasim::config
