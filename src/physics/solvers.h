// Bullet's constraint solver, with two changes: a contact that bounces neither gains nor loses energy by it, and one
// that sticks does not creep (friction_anchors.h).
//
// Bullet gives a contact that bounces the sum of three speeds: that of the bounce, that which pushes overlapping bodies
// apart (a fifth of the overlap per substep, and it stays), and, before they touch, that which brings them together by
// the end of the substep. So every bounce gains or loses. Here it happens in the substep in which the bodies would
// touch, and leaves with the speed of the bounce or that of the push, whichever is higher. The speed counts from before
// the substep's gravity: then a ball that falls and bounces for ever has the same energy for ever (a semi-implicit
// Euler step is exact in it).
#pragma once

#include <memory>

class btConstraintSolver;

namespace aurasim::physics {

/// Remembers nothing from one island to the next.
std::unique_ptr<btConstraintSolver> make_solver();

}  // namespace aurasim::physics
