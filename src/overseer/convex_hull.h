// Triangles around points, so that a page can draw a convex hull.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/body_state.h"

namespace aurasim::overseer {

/// Triples of indices, counter-clockwise from outside. None if the points lie in a plane. Incremental, O(n^2): for
/// hulls of physics, some hundred points.
std::vector<std::array<std::uint32_t, 3>> hull_triangles(const std::vector<core::Vec3>& points);

}  // namespace aurasim::overseer
