// Distances of simple shapes in closed form. A spine is a segment through a convex shape: the shape lies within a
// radius around it. That bound is much closer than a sphere where a shape is long.
#pragma once

#include "core/scene.h"

namespace aurasim::physics {

/// A segment from -half to half in the shape's frame.
struct Spine {
  core::Vec3 half = core::Vec3::Zero();
  double radius = 0;      ///< m: the shape is within this distance of the segment
  bool is_exact = false;  ///< the shape is all that is within `radius` of the segment: a ball or a capsule
};

Spine spine_of(const core::ConvexShape& shape);

/// Distance of two segments, m: from -half_a to half_a around a, and from -half_b to half_b around b. `p_AB`: b - a.
double segments_apart(const core::Vec3& half_a, const core::Vec3& p_AB, const core::Vec3& half_b);

/// Distance of a box and a segment, m; 0 if they meet. `p`, `half`: the segment's middle and half of it, in the box's
/// frame.
double segment_from_box(const core::Vec3& p, const core::Vec3& half, const core::Vec3& half_extents);

}  // namespace aurasim::physics
