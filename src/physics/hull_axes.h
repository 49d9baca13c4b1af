// Finds the axis along which two convex polyhedra are farthest apart, or overlap least, among the normals of their
// faces and the directions across two of their edges (separating axes).
//
// All faces, and all pairs of edges that can be closest (Gauss map), are searched, so the result depends on nothing but
// the two shapes and their relative pose. Two things make it fast and change no bit of it. The axis of the last call is
// tried first, and mostly shows that two hulls are still apart. And a face is skipped if points of the hulls that are
// already known show that it cannot be best: the gap along a unit vector n is at most n . (b - a) for any a in A, b in
// B.
#pragma once

#include <cstdint>
#include <optional>

#include <LinearMath/btTransform.h>

#include "physics/hull_faces.h"

namespace aurasim::physics {

struct HullAxis {
  enum class Kind : std::uint8_t { kNone, kFaceOfA, kFaceOfB, kEdges };

  Kind kind = Kind::kNone;
  std::uint32_t of_a = 0, of_b = 0;  ///< numbers of the faces or edges
};

struct HullGap {
  HullAxis axis;
  btVector3 normal{0, 0, 0};  ///< of length 1, from A to B, in A's frame
  double gap = 0;             ///< m; negative: overlap
};

/// Nothing if there is an axis along which the hulls are more than `margin_m` apart. Of axes that are equal to within a
/// small share of the margin, a face of A is preferred to one of B, and that to edges. `last`: an axis to try first;
/// set to one to try first next time.
std::optional<HullGap> closest_axis(const HullFaces& a, const HullFaces& b, const btTransform& X_AB, double margin_m,
                                    HullAxis& last);

/// True if the normal of a face shows that the hulls do not touch while B moves by `way` in A's frame.
bool stay_apart(const HullFaces& a, const HullFaces& b, const btTransform& X_AB, const btVector3& way);

}  // namespace aurasim::physics
