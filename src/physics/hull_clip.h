// The contact points of two convex polyhedra along the axis that hull_axes.h has found: one face clipped to the outline
// of the other, or the crossing of two edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <LinearMath/btTransform.h>

#include "physics/contact_features.h"
#include "physics/hull_axes.h"
#include "physics/hull_faces.h"

namespace aurasim::physics {

struct HullPoint {
  btVector3 on_a{0, 0, 0}, on_b{0, 0, 0};  ///< in A's frame
  double gap = 0;                          ///< along the normal, m; negative: overlap
  ContactFeatures features;
};

struct HullPoints {
  btVector3 normal{0, 0, 0};  ///< from A to B, in A's frame
  int count = 0;
  std::array<HullPoint, 4> points;
};

/// Up to 4 points with gaps of at most `margin_m`: the deepest one, and those that span the largest area. `before`:
/// the features of the last points, which are kept rather than others that are hardly better.
HullPoints contact_points(const HullFaces& a, const HullFaces& b, const btTransform& X_AB, const HullGap& closest,
                          double margin_m, std::span<const ContactFeatures> before);

/// Adds up to 4 of the points to `to`, which has a normal and no points. Points and `before` as in contact_points().
void choose_points(std::span<const HullPoint> points, double margin_m, std::span<const ContactFeatures> before,
                   HullPoints& to);

/// The face at the hull's farthest corner against `normal` that faces it most.
std::uint32_t opposite_face(const HullFaces& hull, const btVector3& normal);

/// Names of the features of a hull.
inline std::int32_t corner_feature(std::uint32_t number) { return static_cast<std::int32_t>(3 * number); }
inline std::int32_t edge_feature(std::uint32_t number) { return static_cast<std::int32_t>(3 * number + 1); }
inline std::int32_t face_feature(std::uint32_t number) { return static_cast<std::int32_t>(3 * number + 2); }

}  // namespace aurasim::physics
