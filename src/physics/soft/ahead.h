// Contacts ahead of time: finds where two bodies will touch within the step if they move on as now.
#pragma once

#include <optional>

#include <LinearMath/btVector3.h>

class btCollisionObject;

namespace aurasim::physics {

struct SoftMeeting {
  btVector3 until;               ///< way of a relative to b until they touch, m
  btVector3 normal;              ///< normal at the touch, from a to b
  btVector3 r_a, r_b;            ///< a point of the touch, from the centres of mass, m
  int part_a = -1, part_b = -1;  ///< parts of compounds that touch; -1: no compound
};

/// The first touch of two bodies in a step. `way`: motion of a relative to b in the step, m. Nothing if they do not
/// meet, or touch already. Rotation is ignored.
std::optional<SoftMeeting> meeting_ahead(const btCollisionObject& a, const btCollisionObject& b, const btVector3& way);

}  // namespace aurasim::physics
