// A hard case of rigid body dynamics: a scene, how long to watch it, and what its motion should be.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/scene.h"

namespace aurasim::lab {

/// All bodies of one state, ascending by id.
struct Moment {
  double t_s = 0;
  double step_s = 0;  ///< step of the physics; in free fall the velocity is half a step ahead of the positions
  std::span<const core::BodyRecord> bodies;
};

/// How the errors of all states become one number.
enum class Over : std::uint8_t { kLargest, kLast, kMean };

struct Metric {
  std::string measured;
  std::string unit;
  Over over = Over::kLargest;
  std::function<double(const Moment&)> error;
};

struct Case {
  std::string name;
  std::string reference;   ///< the reference solution, and its source
  std::uint64_t seed = 0;  ///< 0: nothing is random
  double duration_s = 1;
  core::Scene scene = {};
  std::vector<Metric> metrics = {};
  double border_x_m = 0;     ///< x of the border between two nodes
  double uncertainty = 0.5;  ///< U of docs/design.md, "Swept auras"; 1 where contacts throw resting bodies
  double contact_erp = 0.2;
  std::optional<bool> continuous = {};  ///< continuous collision detection; none: with the soft step
};

/// Every case.
std::vector<Case> stability_cases();
/// Throws std::invalid_argument if there is none of this name.
Case stability_case(const std::string& name);

std::vector<Case> flight_cases();
std::vector<Case> contact_cases();
std::vector<Case> pile_cases();
std::vector<Case> joint_cases();

}  // namespace aurasim::lab
