// Blocks: square columns of side `physics.block`, fixed in the world. The soft step solves contacts in the order of
// blocks (docs/design.md, "Blocks").
#pragma once

#include <vector>

#include "core/body_state.h"

namespace aurasim::core {

struct Scene;

inline constexpr double kUsualBlock_m = 16;
inline constexpr double kSmallestBlock_m = 1;
inline constexpr double kLargestBlock_m = 1e6;

// Shares of the side of a block. A body keeps its block until its centre is farther outside than the margin. Bodies
// with a larger bounding radius are giants. docs/design.md derives that 2 margins, 8 radii and 4 gaps of contacts have
// to fit in a side; so the gap of a contact may be 0.012 of the side.
inline constexpr double kBlockMargin = 1.0 / 32;
inline constexpr double kBlockRadius = 1.0 / 9;

/// The block that contains a point.
Block block_at(const Vec3& p_W, double side_m);

/// How far a point is outside of a block, along x or y, m; 0 inside.
double outside_m(const Vec3& p_W, const Block& block, double side_m);

/// True if a body with this centre has to leave its block.
inline bool leaves(const Vec3& p_WB, const Block& block, double side_m) {
  return outside_m(p_WB, block, side_m) > kBlockMargin * side_m;
}

/// True if each known block is within one side of its body's centre, or is that of another body for which this is true
/// (the bodies of a mechanism have one block).
bool blocks_are_near(const std::vector<BodyRecord>& bodies, double side_m);

/// The side of `physics.block: auto`: the smallest of 16, 32, 64 ... m for which at most one body of the scene in a
/// hundred is a giant. The reach of a jointed body is counted from the body of the lowest id in its mechanism. Bodies
/// that clients add later do not count.
double usual_block_m(const Scene& scene);

}  // namespace aurasim::core
