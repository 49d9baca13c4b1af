// Results of a world besides the state of its bodies.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"
#include "core/observation.h"
#include "core/order.h"

namespace aurasim::physics {

/// The first contact of a pair, seen before the solver acts on it.
struct Collision {
  core::Step step = 0;  ///< the state being computed when it was seen
  core::BodyId a{};     ///< a < b
  core::BodyId b{};
  double penetration_m = 0;       ///< positive: the shapes overlap
  double relative_speed_m_s = 0;  ///< relative speed at the contact point, before the solver acts
  core::Vec3 p_W = core::Vec3::Zero();
};

/// A body that was removed from the world; `step` is the first state without it.
struct Removal {
  core::Step step = 0;
  core::BodyId body{};
  std::string fault;  ///< how it broke down (core/limits.h); empty: an order removed it
};

/// A request that was not executed on a body here.
struct Declined {
  std::uint64_t request = 0;
  std::string why;
};

struct RayHit {
  std::optional<core::ObjectRef> object;  ///< nothing: nothing was hit
  core::Vec3 p_W = core::Vec3::Zero();
  core::Vec3 normal_W = core::Vec3::Zero();
  double distance_m = 0;
};

/// Contact impulses in a state that was made up in a scratch world.
struct MadeUpContacts {
  core::Step step = 0;
  std::vector<core::ContactImpulse> contacts;  ///< ascending (a, b)
};

/// Receives each state that a scratch world made up (docs/design.md, "The same bits"). `bodies`: the records of the
/// cluster's bodies in state `step`, in ascending order of id.
using CatchUpListener = std::function<void(core::Step step, std::span<const core::BodyRecord> bodies)>;

/// A body that coupled regions handed over in the last step. It left in the state before.
struct Moved {
  core::BodyRecord body;   ///< in the state before the step, with what orders of the step have done to it
  core::RegionId other{};  ///< where it came from or went to
};

}  // namespace aurasim::physics
