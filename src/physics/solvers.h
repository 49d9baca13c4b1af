// Bullet's constraint solver with two changes: bouncing contacts neither gain nor lose energy beyond their restitution,
// and sticking contacts do not creep (friction_anchors.h).
//
// Bullet gives a bouncing contact the sum of three speeds: that of the bounce, that which pushes overlapping bodies
// apart (a fifth of the overlap per substep, and it stays), and, before they touch, that which brings them together by
// the end of the substep. So every bounce gains or loses energy. Here the bounce happens in the substep in which the
// bodies would touch, with the speed of the bounce or of the push, whichever is higher. The approach speed is taken
// before the substep's gravity. Then a ball that bounces for ever keeps its energy for ever (a semi-implicit Euler step
// is exact in it).
#pragma once

#include <memory>

class btConstraintSolver;

namespace aurasim::physics {

/// Makes the solver. It keeps no state from one island to the next.
std::unique_ptr<btConstraintSolver> make_solver();

}  // namespace aurasim::physics
