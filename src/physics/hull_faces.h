// Faces, edges and corners of a convex polyhedron with their neighbours, as hull_axes.h and hull_clip.h need them. Made
// once for each shape.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <LinearMath/btVector3.h>

#include "core/body_state.h"

class btCollisionShape;

namespace aurasim::physics {

/// Points or directions by coordinate. Padded with the first one to whole lanes (soft::kPointsAtOnce).
class PointLanes {
 public:
  void assign(const std::vector<btVector3>& points);
  std::size_t size() const { return size_; }
  std::size_t padded_size() const { return coordinates_[0].size(); }
  btVector3 operator[](std::size_t i) const { return {coordinates_[0][i], coordinates_[1][i], coordinates_[2][i]}; }
  const double* x() const { return coordinates_[0].data(); }
  const double* y() const { return coordinates_[1].data(); }
  const double* z() const { return coordinates_[2].data(); }
  /// Index of the farthest point in a direction; the first one of several.
  std::size_t farthest(const btVector3& direction) const;
  /// The least and the largest product of a point with a direction.
  std::array<double, 2> reach(const btVector3& direction) const;

 private:
  std::size_t size_ = 0;
  std::array<std::vector<double>, 3> coordinates_;
};

/// In the shape's frame, metres. Faces are planar polygons: coplanar triangles are one face.
struct HullFaces {
  struct Edge {
    std::uint32_t from, to;     ///< corners
    std::uint32_t left, right;  ///< faces: `left` lies left of the way from `from` to `to`, seen from outside
  };

  PointLanes corners;
  PointLanes normals;           ///< by face, of length 1, outwards
  std::vector<double> offsets;  ///< by face: all points of the hull have normal . x <= offset
  std::vector<Edge> edges;
  /// The corners of face f are loop_corners[face_begin[f]] to loop_corners[face_begin[f + 1] - 1], counter-clockwise
  /// seen from outside. loop_edges has the edge that leads from each corner to the next one.
  std::vector<std::uint32_t> face_begin, loop_corners, loop_edges;
  /// The faces at corner c are corner_faces[corner_begin[c]] to corner_faces[corner_begin[c + 1] - 1], ascending.
  std::vector<std::uint32_t> corner_begin, corner_faces;
  btVector3 centre{0, 0, 0};  ///< a point inside
  double inner_radius = 0;    ///< radius of a ball about the centre inside the hull
  double size = 0;            ///< radius of a ball about the centre around the hull

  std::size_t face_count() const { return offsets.size(); }
  btVector3 along(const Edge& edge) const { return corners[edge.to] - corners[edge.from]; }
};

/// Null if the points have no volume.
std::unique_ptr<const HullFaces> hull_faces(const std::vector<core::Vec3>& points);
std::unique_ptr<const HullFaces> box_faces(const core::Vec3& half_extents);

/// Attaches faces to a convex shape; null for none. `faces` have to outlive the shape.
void set_hull_faces(btCollisionShape& shape, const HullFaces* faces);
/// The faces of a convex shape; null for shapes without.
const HullFaces* hull_faces_of(const btCollisionShape& shape);

}  // namespace aurasim::physics
