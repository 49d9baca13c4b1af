// Contacts ahead of time: where two bodies that go on as they move now will touch within the step.
#pragma once

#include <optional>

#include <LinearMath/btVector3.h>

class btCollisionObject;

namespace aurasim::physics {

struct SoftMeeting {
  btVector3 until;               ///< of a as seen from b until they touch, m
  btVector3 normal;              ///< there, from a to b
  btVector3 r_a, r_b;            ///< of a point at which they touch, from the centres of mass, m
  int part_a = -1, part_b = -1;  ///< of compounds: those that touch there
};

/// `way` of a as seen from b in the step, m. None if they pass each other, or touch now. Turns are not looked at.
std::optional<SoftMeeting> meeting_ahead(const btCollisionObject& a, const btCollisionObject& b, const btVector3& way);

}  // namespace aurasim::physics
