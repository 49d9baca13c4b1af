// The surface of a convex hull as triangles, for the page and for exported models.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/body_state.h"

namespace aurasim::physics {

/// Triples of indices into `points` (m), counter-clockwise seen from outside. Empty if all points lie in a plane.
std::vector<std::array<std::uint32_t, 3>> hull_triangles(const std::vector<core::Vec3>& points);

}  // namespace aurasim::physics
