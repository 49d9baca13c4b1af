// Touching bodies of a soft step, and their contact points.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "physics/contact_cache.h"
#include "physics/soft/lanes.h"

namespace aurasim::physics {

/// Contact points of two bodies with one normal, at the start of a step.
struct SoftPatch {
  struct Point {
    soft::Real r_a[3] = {}, r_b[3] = {};  ///< the point from the centres of mass, m
    soft::Real gap = 0;                   ///< m; negative: overlap
    soft::Real impulse = 0;               ///< impulse of the last substep, N s
  };

  btPersistentManifold* manifold = nullptr;
  bool ahead = false;        ///< a contact ahead of time: the manifold, if any, does not have the points
  bool is_foreign = false;   ///< another region has found it; it has no manifold here
  bool has_pressed = false;  ///< for contacts ahead of time: the two bodies have touched in the step
  int a = 0, b = 0;          ///< user indices; those of statics are negative
  std::array<std::int8_t, soft::kMostPoints> of = {};  ///< indices of the points in the manifold
  std::int8_t count = 0;
  soft::Real normal[3] = {};  ///< from a to b
  soft::Real belt[3] = {};    ///< velocity of b's surface relative to a's by belts, m/s
  soft::Real friction = 0, restitution = 0, spinning_m = 0, rolling_m = 0;
  soft::Real rub_1 = 0, rub_2 = 0, twist = 0;  ///< impulses of friction of the last substep, N s and N m s
  std::array<Point, soft::kMostPoints> points;
};

/// A manifold with a point, or with a contact ahead of time.
struct SoftTouch {
  btPersistentManifold* manifold = nullptr;  ///< may be null for a contact ahead of time
  int a = 0, b = 0;                          ///< user indices
  std::uint32_t slot_a = 0, slot_b = 0;
  Parts parts;
  bool acts = true;                                      ///< false: the bodies pass through each other
  bool ahead = false;                                    ///< a contact ahead of time
  std::uint32_t list = 0, first_patch = 0, patches = 0;  ///< SoftContacts::patches_of()
};

/// Slots of two sleepers that touch.
struct SleepersTouch {
  std::uint32_t slot_a = 0, slot_b = 0;
};

/// The slot of a body in SoftIslands; 0 for statics and for objects in no world.
inline std::uint32_t slot_of(const btCollisionObject& object) {
  return static_cast<std::uint32_t>(std::max(0, object.getUserIndex3()));
}

}  // namespace aurasim::physics
