// What a world has to say besides the state of its bodies.
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
  double relative_speed_m_s = 0;  ///< of the two bodies at the contact point, before the solver
  core::Vec3 p_W = core::Vec3::Zero();
};

/// A body that was taken out: state `step` is the first without it.
struct Removal {
  core::Step step = 0;
  core::BodyId body{};
  std::string fault;  ///< what physics has made of it (core/limits.h); empty: an order took it out
};

/// A request that a body here has not obeyed.
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

/// What has pressed on what in a state that was made up in a scratch world.
struct MadeUpContacts {
  core::Step step = 0;
  std::vector<core::ContactImpulse> contacts;  ///< ascending (a, b)
};

/// Tells a listener about states that were made up in a scratch world (docs/design.md, "The same bits"):
/// the records of the cluster's bodies in state `step`, in ascending order of id.
using CatchUpListener = std::function<void(core::Step step, std::span<const core::BodyRecord> bodies)>;

}  // namespace aurasim::physics
