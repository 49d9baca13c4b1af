#include "physics/hull_shape.h"

#include <type_traits>
#include <utility>

#include "physics/bullet_convert.h"
#include "physics/soft/lanes.h"

namespace aurasim::physics {
namespace {

template <class Number>
std::size_t farthest(const Number* x, const Number* y, const Number* z, std::size_t count, const Number (&along)[3]) {
  if constexpr (std::is_same_v<Number, double>) {
    return soft::kernel().farthest_double(x, y, z, count, along);
  } else {
    return soft::kernel().farthest_single(x, y, z, count, along);
  }
}

}  // namespace

/// The type is one that Bullet does not know, so Bullet calls the virtual functions of this class.
HullShape::HullShape(const btVector3* points, int count) {
  m_shapeType = CUSTOM_POLYHEDRAL_SHAPE_TYPE;
  const std::size_t filled =
      (static_cast<std::size_t>(count) + soft::kPointsAtOnce - 1) / soft::kPointsAtOnce * soft::kPointsAtOnce;
  for (std::vector<btScalar>& coordinate : coordinates_) coordinate.reserve(filled);
  for (std::size_t i = 0; i < filled; ++i) {
    const btVector3& point = points[i < static_cast<std::size_t>(count) ? i : 0];
    if (i < static_cast<std::size_t>(count)) addPoint(point, false);
    for (int k = 0; k < 3; ++k) coordinates_[static_cast<std::size_t>(k)].push_back(point[k]);
  }
  recalcLocalAabb();
}

void HullShape::set_faces(std::unique_ptr<const HullFaces> faces) {
  faces_ = std::move(faces);
  set_hull_faces(*this, faces_.get());
}

/// Exact: Bullet's bounds are those of the turned box around the hull, with which a heap has twice as many pairs.
void HullShape::getAabb(const btTransform& X, btVector3& low, btVector3& high) const {
  if (!faces_) return btConvexHullShape::getAabb(X, low, high);
  for (int k = 0; k < 3; ++k) {
    const auto [least, most] = faces_->corners.reach(X.getBasis()[k]);
    low[k] = least + X.getOrigin()[k];
    high[k] = most + X.getOrigin()[k];
  }
}

btVector3 HullShape::localGetSupportingVertexWithoutMargin(const btVector3& direction) const {
  const btScalar along[3] = {direction.x(), direction.y(), direction.z()};
  const std::size_t i =
      farthest(coordinates_[0].data(), coordinates_[1].data(), coordinates_[2].data(), coordinates_[0].size(), along);
  return {coordinates_[0][i], coordinates_[1][i], coordinates_[2][i]};
}

BoxShape::BoxShape(const core::Vec3& half_extents)
    : btBoxShape(to_bullet(half_extents)), faces_(box_faces(half_extents)) {
  set_hull_faces(*this, faces_.get());
}

}  // namespace aurasim::physics
