// How a body turns while nothing acts on it (Euler's equations). Bullet keeps the spin where the momentum should be
// kept, or adds a gyroscopic torque that loses or gains energy; here the angular momentum stays to the last digits and
// the energy error stays bounded.
#pragma once

#include <optional>

#include "core/body_state.h"

class btRigidBody;

namespace aurasim::physics {

struct Rotation {
  core::Mat3 R_WB;
  core::Vec3 w_WB;  ///< rad/s
};

/// `inertia`: about the axes of the body's frame, kg m^2, all above 0. The motion in between is a chain of turns about
/// these axes, symmetric in time and symplectic (A. Dullweber, B. Leimkuhler, R. McLachlan, J. Chem. Phys. 107, 1997),
/// of at most kTurn radians each.
Rotation rotate_freely(const Rotation& start, const core::Vec3& inertia, double dt_s);
inline constexpr double kTurn = 0.05;
inline constexpr int kMostTurns = 256;  ///< of one step; a body that turns by more than 12 rad in it is not resolved

/// Below this, rad/s, the spin's change in a step is lost in what contacts do; bodies at rest pay nothing.
inline constexpr double kSlowSpin = 0.001;

/// A sphere's or a cube's spin does not change.
bool turns_evenly(const core::Vec3& inertia);

/// Of a body whose spin changes while nothing acts on it, kg m^2; of others none.
std::optional<core::Vec3> tumbling_inertia(const btRigidBody& body);

}  // namespace aurasim::physics
