// Limits of worlds and of commands: one table for the page, the command line, the nodes and physics. Limits that depend
// on the run (tolerances.speed, the substep) are derived from it where a command is checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace aurasim::core::limits {

// A body beyond these three limits is taken out of the world (docs/decisions/0017-nothing-waits-for-ever.md). At 1e7 m
// a double still resolves 2 nm.
inline constexpr double kFarthestBody_m = 1e7;
inline constexpr double kFastestBody_m_s = 1e6;
inline constexpr double kFastestSpin_rad_s = 1e6;

// Limits of statics on paths and of belts, because bodies that they push become as fast.
inline constexpr double kFastestStatic_m_s = 100;
inline constexpr double kFastestStatic_rad_s = 50;

// Limits of scene files. Within them no state becomes non-finite and no body is taken out at once. They are wider than
// those of commands, because the author of a scene also chooses its regions and its step.
/// radius, edge, height; for bodies that move, thickness in any direction
inline constexpr double kSmallestSize_m = 1e-4;
inline constexpr double kLargestSize_m = 1e6;
inline constexpr double kLightestOfScene_kg = 1e-6;
inline constexpr double kHeaviestOfScene_kg = 1e9;
inline constexpr double kSmallestInertia_kg_m2 = 1e-15;  ///< the lightest ball of the smallest size has 4e-15
inline constexpr double kLargestInertia_kg_m2 = 1e12;

// Limits of commands, and of places in scenes.
inline constexpr double kFarthestPlace_m = 1e6;
inline constexpr double kHardestImpulse_Ns = 1e7;
inline constexpr double kHardestPush = 1e9;             ///< setpoints, N or N m; also rad, m and gains
inline constexpr std::size_t kMostSetpoints = 100'000;  ///< of bodies, and of joints, in one message
inline constexpr std::size_t kMostStaticSetpoints = 64;
inline constexpr double kLightest_kg = 1e-3;
inline constexpr double kHeaviest_kg = 1e6;
inline constexpr double kSmallestRadius_m = 0.01;  ///< bounding sphere of a shape
inline constexpr double kLargestRadius_m = 200;
inline constexpr double kThinnest_m = 1e-3;  ///< thickness in any direction, for bodies that move
inline constexpr double kSlowestRate = 0.01;
inline constexpr double kFastestRate = 10;
inline constexpr std::int64_t kMostStepsAhead = 1'000'000;  ///< how far ahead an order's state may be
inline constexpr std::uint64_t kMostBodies = 100'000;
inline constexpr std::size_t kMostStatics = 10'000;
inline constexpr std::size_t kMostKinds = 10'000;
inline constexpr std::size_t kMostTriangles = 200'000;

/// Largest spin that Bullet keeps, rad/s: it turns a body by at most a quarter turn in a substep and removes the rest.
constexpr double fastest_spin_rad_s(double substep_s) { return std::numbers::pi / 2 / substep_s; }

constexpr bool is_rate(double rate) { return rate >= kSlowestRate && rate <= kFastestRate; }

}  // namespace aurasim::core::limits
