// Rotation of a body while nothing acts on it (Euler's equations). Bullet conserves the spin instead of the angular
// momentum, or adds a gyroscopic torque that loses or gains energy. Here the angular momentum is conserved to the last
// digits, and the energy error stays bounded.
#pragma once

#include <optional>

#include "core/body_state.h"

class btRigidBody;

namespace aurasim::physics {

struct Rotation {
  core::Mat3 R_WB;
  core::Vec3 w_WB;  ///< rad/s
};

/// The rotation `dt_s` after `start`. `inertia`: about the axes of the body's frame, kg m^2, all above 0. Computes a
/// chain of turns about these axes, symmetric in time and symplectic (A. Dullweber, B. Leimkuhler, R. McLachlan, J.
/// Chem. Phys. 107, 1997), of at most kTurn radians each.
Rotation rotate_freely(const Rotation& start, const core::Vec3& inertia, double dt_s);
inline constexpr double kTurn = 0.05;
/// most turns in one step; a body that turns by more than 12 rad in a step is not resolved
inline constexpr int kMostTurns = 256;

/// Slower spins (rad/s) are not corrected: their change in a step is negligible beside contacts. So bodies at rest cost
/// nothing.
inline constexpr double kSlowSpin = 0.001;

/// Does the spin stay constant while nothing acts on the body, as of a sphere or a cube?
bool turns_evenly(const core::Vec3& inertia);

/// Inertia (kg m^2) of a body whose spin changes while nothing acts on it; nothing for other bodies.
std::optional<core::Vec3> tumbling_inertia(const btRigidBody& body);

}  // namespace aurasim::physics
