// Small scenes for simulated clusters, from a seed, and how many seeds.
#pragma once

#include "core/scene.h"

namespace aurasim::test {

/// The side of a region in the tests of clusters, in m.
inline constexpr double kCell = 9;

/// `count` spheres, boxes and capsules over an area of `width_x_m` x `width_y_m` around the origin, thrown about at up
/// to `speed_m_s` along x and y above a plane; a tenth of them come later, from an injector.
core::Scene thrown_bodies(std::size_t count, double width_x_m, double width_y_m, double speed_m_s, std::uint64_t seed);

/// The same in pairs, each held together by a joint that drives: hinges that turn without end, or go to and fro by a
/// stiff drive, and sliders with springs and friction.
core::Scene driven_pairs(std::size_t count, double width_x_m, double width_y_m, double speed_m_s, std::uint64_t seed);

/// Side of the blocks for a seed, 4 to 64 m.
double block_of(int seed);

/// How many seeds a rule is tried with: AURASIM_SEEDS, if it is set.
int seeds_or(int usual);

}  // namespace aurasim::test
