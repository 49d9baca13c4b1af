// Auras travel rounded (messages/aura_codec.cpp), so a receiver allows for a body that is not exactly at its published
// pose.
#pragma once

namespace aurasim::core {

/// Positions are sent in multiples of this: a power of two, so that doubles hold them exactly. Metres.
inline constexpr double kPositionGrain_m = 1.0 / 4096;

/// A rotation is sent within this angle (radians).
inline constexpr double kRotationError_rad = 1e-5;

/// How far a point of a body's surface can be from where its aura says. Rounding by half a grain along each axis moves
/// a point by up to 0.87 grains; the rest of the grain covers the velocities' single precision (at 1,000 m/s and for
/// 0.1 s: 6 um).
inline constexpr double rounded_within_m(double radius_m) { return kPositionGrain_m + kRotationError_rad * radius_m; }

}  // namespace aurasim::core
