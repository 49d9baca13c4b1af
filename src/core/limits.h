// What a world bears, and what may be asked of it: one table for the page, the command line, the nodes and physics.
// Limits that hang on a run (tolerances.speed, the substep) are derived from it where a command is checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace aurasim::core::limits {

// A body beyond these is taken out of the world, wherever it is hosted (docs/decisions/0017-nothing-waits-for-ever.md).
// A double still tells 2 nm apart out there; nothing that is simulated in earnest comes near.
inline constexpr double kFarthestBody_m = 1e7;
inline constexpr double kFastestBody_m_s = 1e6;
inline constexpr double kFastestSpin_rad_s = 1e6;

// Of statics on paths, and of belts: what they push gets as fast.
inline constexpr double kFastestStatic_m_s = 100;
inline constexpr double kFastestStatic_rad_s = 50;

// Of scene files: what a world bears without a state that is not finite, or a body that is taken out of it at once.
// Wider than what commands may ask for, since who writes a scene chooses its regions and its step.
inline constexpr double kSmallestSize_m = 1e-4;  ///< radius, edge, height; thickness in any direction, of what moves
inline constexpr double kLargestSize_m = 1e6;
inline constexpr double kLightestOfScene_kg = 1e-6;
inline constexpr double kHeaviestOfScene_kg = 1e9;
inline constexpr double kSmallestInertia_kg_m2 = 1e-15;  ///< that of the lightest ball of the smallest size: 4e-15
inline constexpr double kLargestInertia_kg_m2 = 1e12;

// Of commands, and places of scenes.
inline constexpr double kFarthestPlace_m = 1e6;
inline constexpr double kHardestImpulse_Ns = 1e7;
inline constexpr double kHardestPush = 1e9;             ///< N or N m, of setpoints; also rad, m and their gains
inline constexpr std::size_t kMostSetpoints = 100'000;  ///< in one message
inline constexpr std::size_t kMostStaticSetpoints = 64;
inline constexpr double kLightest_kg = 1e-3;
inline constexpr double kHeaviest_kg = 1e6;
inline constexpr double kSmallestRadius_m = 0.01;  ///< of the sphere around a shape
inline constexpr double kLargestRadius_m = 200;
inline constexpr double kThinnest_m = 1e-3;  ///< in any direction, of what moves
inline constexpr double kSlowestRate = 0.01;
inline constexpr double kFastestRate = 10;
inline constexpr std::int64_t kMostStepsAhead = 1'000'000;  ///< of an order for a later state
inline constexpr std::uint64_t kMostBodies = 100'000;
inline constexpr std::size_t kMostStatics = 10'000;
inline constexpr std::size_t kMostKinds = 10'000;
inline constexpr std::size_t kMostTriangles = 200'000;

/// Bullet turns a body by at most a quarter turn in a substep and takes the rest of its spin away.
constexpr double fastest_spin_rad_s(double substep_s) { return std::numbers::pi / 2 / substep_s; }

constexpr bool is_rate(double rate) { return rate >= kSlowestRate && rate <= kFastestRate; }

}  // namespace aurasim::core::limits
