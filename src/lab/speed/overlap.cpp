#include "lab/speed/overlap.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include "core/spatial_grid.h"
#include "physics/clearance.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

/// How far a shape reaches from its origin along a unit vector in its own frame.
struct ReachAlong {
  Vec3 n_B;

  double operator()(const core::Sphere& s) const { return s.radius; }
  double operator()(const core::Box& s) const { return s.half_extents.dot(n_B.cwiseAbs()); }
  double operator()(const core::Capsule& s) const { return s.radius + 0.5 * s.height * std::abs(n_B.z()); }
  double operator()(const core::ConvexHull& s) const {
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vec3& point : s.points) farthest = std::max(farthest, point.dot(n_B));
    return farthest;
  }
  template <class Other>
  double operator()(const Other&) const {
    throw std::invalid_argument("how far bodies of this shape overlap is not known");
  }
};

/// Height of the point above the plane, metres.
double height_above(const core::Plane& plane, const core::Pose& pose, const Vec3& p_W) {
  return plane.normal.normalized().dot(pose.q_WB.conjugate() * (p_W - pose.p_WB)) - plane.offset;
}

bool is_box(const core::Shape& shape) { return std::holds_alternative<core::Box>(shape); }

}  // namespace

struct Overlaps::Placed {
  core::PrototypeId prototype{};
  core::Pose pose;
};

Overlaps::Overlaps(const core::Scene& scene) : first_static_(scene.prototypes.size()) {
  scene_.shapes = scene.shapes;
  scene_.materials = scene.materials;
  scene_.prototypes = scene.prototypes;
  scene_.statics = scene.statics;
  for (const core::StaticBody& fixed : scene.statics) {
    core::Prototype& prototype = scene_.prototypes.emplace_back();
    prototype.shape = fixed.shape;
    prototype.material = fixed.material;
  }
  clearance_ = physics::make_clearance_query(scene_);
  for (const core::JointSpec& joint : scene.joints) {
    if (joint.b) joined_.insert(std::minmax(joint.a, *joint.b));
  }
}

const core::Shape& Overlaps::shape_of(core::PrototypeId prototype) const {
  return scene_.shapes[scene_.prototypes[core::value_of(prototype)].shape].shape;
}

Overlaps::Placed Overlaps::placed(const core::BodyRecord& body) const {
  return {body.prototype, {body.p_WB, core::Quat(body.R_WB)}};
}

Overlaps::Placed Overlaps::placed_static(std::size_t index) const {
  return {core::PrototypeId{static_cast<std::uint32_t>(first_static_ + index)}, scene_.statics[index].pose};
}

/// Distance by which the shapes would have to part along n, a unit vector from a to b. The overlap is the least value
/// over all n, so each n gives an upper bound.
double Overlaps::depth_along(const Placed& a, const Placed& b, const Vec3& n_W) const {
  const double reach_a = std::visit(ReachAlong{a.pose.q_WB.conjugate() * n_W}, shape_of(a.prototype));
  const double reach_b = std::visit(ReachAlong{b.pose.q_WB.conjugate() * -n_W}, shape_of(b.prototype));
  return reach_a + reach_b - n_W.dot(b.pose.p_WB - a.pose.p_WB);
}

/// Two boxes by the axes that may separate them, exactly. Others by Bullet's GJK and EPA, which now and then finds no
/// result where two just touch; the same axes keep that from looking deep.
double Overlaps::depth(const Placed& a, const Placed& b) const {
  const Vec3 p_AB = b.pose.p_WB - a.pose.p_WB;
  double least = std::numeric_limits<double>::infinity();
  if (!is_box(shape_of(a.prototype)) || !is_box(shape_of(b.prototype))) {
    least = -clearance_->clearance(a.prototype, a.pose, b.prototype, b.pose, 0);
  }
  const core::Mat3 A = a.pose.q_WB.toRotationMatrix(), B = b.pose.q_WB.toRotationMatrix();
  const auto try_axis = [&](const Vec3& axis) {
    constexpr double kParallel = 1e-6;
    const double length = axis.norm();
    if (length < kParallel || least <= 0) return;
    const Vec3 n_W = axis / (p_AB.dot(axis) < 0 ? -length : length);
    least = std::min(least, depth_along(a, b, n_W));
  };
  try_axis(p_AB);
  for (int i = 0; i < 3; ++i) {
    try_axis(A.col(i));
    try_axis(B.col(i));
    for (int j = 0; j < 3; ++j) try_axis(A.col(i).cross(B.col(j)));
  }
  return std::max(least, 0.0);
}

double Overlaps::between_bodies(std::span<const core::BodyRecord> bodies) const {
  const auto radius = [&](const core::BodyRecord& body) { return clearance_->bounding_radius(body.prototype); };
  double largest = 0;
  for (const core::BodyRecord& body : bodies) largest = std::max(largest, radius(body));
  core::SpatialGrid grid;
  grid.clear(std::max(4 * largest, 1e-3));
  for (std::size_t i = 0; i < bodies.size(); ++i) grid.add(static_cast<std::uint32_t>(i), bodies[i].p_WB);
  grid.build();
  double deepest = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const core::BodyRecord& a = bodies[i];
    const Vec3 reach = Vec3::Constant(radius(a) + largest);
    grid.for_each_in(a.p_WB - reach, a.p_WB + reach, [&](std::uint32_t j) {
      const core::BodyRecord& b = bodies[j];
      if (j <= i || (b.p_WB - a.p_WB).norm() >= radius(a) + radius(b)) return;
      if (joined_.contains(std::minmax(a.id, b.id))) return;
      deepest = std::max(deepest, depth(placed(a), placed(b)));
    });
  }
  return deepest;
}

double Overlaps::with_statics(std::span<const core::BodyRecord> bodies) const {
  double deepest = 0;
  for (std::size_t i = 0; i < scene_.statics.size(); ++i) {
    const Placed fixed = placed_static(i);
    const auto* plane = std::get_if<core::Plane>(&shape_of(fixed.prototype));
    for (const core::BodyRecord& body : bodies) {
      if (!plane) {
        deepest = std::max(deepest, depth(placed(body), fixed));
        continue;
      }
      const Vec3 down_B = body.R_WB.transpose() * (fixed.pose.q_WB * -plane->normal.normalized());
      const double reach = std::visit(ReachAlong{down_B}, shape_of(body.prototype));
      deepest = std::max(deepest, reach - height_above(*plane, fixed.pose, body.p_WB));
    }
  }
  return deepest;
}

bool Overlaps::is_inside_a_static(const core::BodyRecord& body) const {
  const double radius = clearance_->bounding_radius(body.prototype);
  for (std::size_t i = 0; i < scene_.statics.size(); ++i) {
    const core::Pose& pose = scene_.statics[i].pose;
    const core::Shape& shape = shape_of(placed_static(i).prototype);
    if (const auto* plane = std::get_if<core::Plane>(&shape)) {
      if (height_above(*plane, pose, body.p_WB) < -radius) return true;
    } else if (const auto* box = std::get_if<core::Box>(&shape)) {
      const Vec3 p_B = pose.q_WB.conjugate() * (body.p_WB - pose.p_WB);
      if ((p_B.cwiseAbs().array() + radius < box->half_extents.array()).all()) return true;
    }
  }
  return false;
}

}  // namespace aurasim::lab
