// Distances between the scene's shapes as they are, without Bullet's margins: boxes, cylinders and hulls are built
// without one, and the radius of spheres and capsules, which is a margin to Bullet, belongs to the shape.
#include <algorithm>
#include <deque>
#include <limits>

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include "physics/bullet_convert.h"
#include "physics/region_world.h"
#include "physics/shapes.h"

namespace aurasim::physics {
namespace {

using core::Pose;
using core::Vec3;

/// A body's shape is one part or, for a compound, several.
struct Part {
  std::unique_ptr<btConvexShape> shape;
  Pose pose;          ///< in the body's frame
  double radius = 0;  ///< of the sphere around the part's own origin
};

struct Parts {
  std::vector<Part> parts;
  double radius = 0;  ///< of the sphere around the body's origin
};

struct MakeParts {
  template <class Convex>
  std::vector<Part> operator()(const Convex& s) const {
    return parts_of({{s, Pose{}}});
  }
  std::vector<Part> operator()(const core::Compound& s) const { return parts_of(s.parts); }
  std::vector<Part> operator()(const core::TriangleMesh&) const { return {}; }
  std::vector<Part> operator()(const core::Plane&) const { return {}; }

  static std::vector<Part> parts_of(const std::vector<core::CompoundPart>& parts) {
    std::vector<Part> made;
    for (const core::CompoundPart& part : parts) {
      const auto radius = std::visit([](const auto& s) { return core::bounding_radius(s); }, part.shape);
      made.push_back({make_convex(part.shape, Margin::kNone), part.pose, radius});
    }
    return made;
  }
};

Pose composed(const Pose& outer, const Pose& inner) {
  return {outer.p_WB + outer.q_WB * inner.p_WB, outer.q_WB * inner.q_WB};
}

/// Poses are relative to A's origin, so that single precision loses nothing far out.
double distance(const Part& a, const btTransform& X_A, const Part& b, const btTransform& X_B, double if_undecided) {
  btVoronoiSimplexSolver simplex;
  btGjkEpaPenetrationDepthSolver penetration;
  btGjkPairDetector detector(a.shape.get(), b.shape.get(), &simplex, &penetration);
  btGjkPairDetector::ClosestPointInput input;
  input.m_transformA = X_A;
  input.m_transformB = X_B;
  btPointCollector closest;
  detector.getClosestPoints(input, closest, nullptr);
  return closest.m_hasResult ? static_cast<double>(closest.m_distance) : if_undecided;
}

class Query : public core::ClearanceQuery {
 public:
  explicit Query(const core::Scene& scene) : scene_(scene) {}

  double clearance(core::PrototypeId a, const Pose& pose_a, core::PrototypeId b, const Pose& pose_b,
                   double limit_m) const override {
    const Parts& parts_a = of(a);
    const Parts& parts_b = of(b);
    const Vec3 p_AB = pose_b.p_WB - pose_a.p_WB;
    const double apart = p_AB.norm() - parts_a.radius - parts_b.radius;
    if (apart > limit_m) return apart;

    double nearest = std::numeric_limits<double>::infinity();
    for (const Part& part_a : parts_a.parts) {
      const Pose X_A = composed({Vec3::Zero(), pose_a.q_WB}, part_a.pose);
      for (const Part& part_b : parts_b.parts) {
        const Pose X_B = composed({p_AB, pose_b.q_WB}, part_b.pose);
        const double spheres_apart = (X_B.p_WB - X_A.p_WB).norm() - part_a.radius - part_b.radius;
        if (spheres_apart > std::min(limit_m, nearest)) {
          nearest = std::min(nearest, spheres_apart);
        } else {
          nearest = std::min(nearest, distance(part_a, to_bullet(X_A), part_b, to_bullet(X_B), spheres_apart));
        }
      }
    }
    return nearest;
  }

  double bounding_radius(core::PrototypeId prototype) const override { return of(prototype).radius; }

  core::BodyTraits traits(core::PrototypeId prototype) const override {
    const core::Prototype& kind = scene_.prototypes.at(core::value_of(prototype));
    return {kind.mass_kg, scene_.materials.at(kind.material).restitution};
  }

 private:
  /// Made when first asked for: a scene may get more prototypes.
  const Parts& of(core::PrototypeId prototype) const {
    while (prototypes_.size() <= core::value_of(prototype)) {
      const core::Shape& shape = scene_.shapes.at(scene_.prototypes.at(prototypes_.size()).shape).shape;
      prototypes_.push_back({std::visit(MakeParts{}, shape), core::bounding_radius(shape)});
    }
    return prototypes_[core::value_of(prototype)];
  }

  const core::Scene& scene_;
  mutable std::deque<Parts> prototypes_;  // references to entries stay good
};

}  // namespace

std::unique_ptr<core::ClearanceQuery> make_clearance_query(const core::Scene& scene) {
  return std::make_unique<Query>(scene);
}

}  // namespace aurasim::physics
