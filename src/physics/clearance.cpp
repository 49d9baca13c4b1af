#include "physics/clearance.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <variant>

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include "physics/bullet_convert.h"
#include "physics/shapes.h"
#include "physics/spine.h"

namespace aurasim::physics {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

/// A convex part of a body's shape. A compound has several, other shapes have one.
struct Part {
  std::unique_ptr<btConvexShape> shape;
  Pose pose;          ///< pose of the part in the body's frame
  double radius = 0;  ///< bounding sphere around the part's own origin
  Spine spine;
  std::optional<Vec3> box;  ///< half extents, if it is a box
};

struct ConvexParts {
  std::vector<Part> parts;
  double radius = 0;  ///< bounding sphere around the body's origin
};

struct MakeParts {
  template <class Convex>
  std::vector<Part> operator()(const Convex& s) const {
    return convex_parts_of({{s, Pose{}}});
  }
  std::vector<Part> operator()(const core::Compound& s) const { return convex_parts_of(s.parts); }
  std::vector<Part> operator()(const core::TriangleMesh&) const { return {}; }
  std::vector<Part> operator()(const core::Plane&) const { return {}; }

  static std::vector<Part> convex_parts_of(const std::vector<core::CompoundPart>& parts) {
    std::vector<Part> made;
    for (const core::CompoundPart& part : parts) {
      const auto radius = std::visit([](const auto& s) { return core::bounding_radius(s); }, part.shape);
      const auto* const box = std::get_if<core::Box>(&part.shape);
      made.push_back({make_convex(part.shape, Margin::kNone), part.pose, radius, spine_of(part.shape),
                      box != nullptr ? std::optional(box->half_extents) : std::nullopt});
    }
    return made;
  }
};

Pose composed(const Pose& outer, const Pose& inner) {
  return {outer.p_WB + outer.q_WB * inner.p_WB, outer.q_WB * inner.q_WB};
}

bool is_ball(const Part& part) { return part.spine.is_exact && part.spine.half.isZero(0); }

/// The point of the part that is farthest in `direction` (a unit vector), without its margin.
btVector3 farthest(const Part& part, const btTransform& X, const btVector3& direction) {
  return X(part.shape->localGetSupportVertexWithoutMarginNonVirtual(direction * X.getBasis()));
}

/// A lower bound of the distance of two parts: a few steps of Gilbert's algorithm (1966) towards their nearest points.
/// Stops once the bound exceeds `enough_m`. Most pairs need no exact distance.
double apart_at_least(const Part& a, const btTransform& X_A, const Part& b, const btTransform& X_B, double enough_m) {
  constexpr int kSteps = 4;
  const btScalar margins = a.shape->getMarginNonVirtual() + b.shape->getMarginNonVirtual();
  btScalar widest = -std::numeric_limits<btScalar>::infinity();
  btVector3 between = X_B.getOrigin() - X_A.getOrigin();  // from a point of A to one of B
  for (int step = 0; step < kSteps && static_cast<double>(widest) <= enough_m; ++step) {
    const btScalar length = between.length();
    if (!(length > SIMD_EPSILON)) break;
    const btVector3 normal = between / length;
    const btVector3 across = farthest(b, X_B, -normal) - farthest(a, X_A, normal);
    widest = std::max(widest, across.dot(normal) - margins);
    const btVector3 on = across - between;
    const btScalar share = -between.dot(on) / std::max(on.length2(), btScalar(SIMD_EPSILON));
    between += std::clamp(share, btScalar(0), btScalar(1)) * on;
  }
  return static_cast<double>(widest);
}

/// Distance of two parts by GJK; `if_undecided` if that fails. Poses are relative to A's origin, so that single
/// precision loses nothing far from the world's origin.
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
    const ConvexParts& parts_a = of(a);
    const ConvexParts& parts_b = of(b);
    const Vec3 p_AB = pose_b.p_WB - pose_a.p_WB;
    const double apart = p_AB.norm() - parts_a.radius - parts_b.radius;
    if (apart > limit_m) return apart;

    double nearest = std::numeric_limits<double>::infinity();
    for (const Part& part_a : parts_a.parts) {
      const Pose X_A = composed({Vec3::Zero(), pose_a.q_WB}, part_a.pose);
      for (const Part& part_b : parts_b.parts) {
        const Pose X_B = composed({p_AB, pose_b.q_WB}, part_b.pose);
        nearest = std::min(nearest, between(part_a, X_A, part_b, X_B, std::min(limit_m, nearest)));
      }
    }
    return nearest;
  }

  double bounding_radius(core::PrototypeId prototype) const override { return of(prototype).radius; }

 private:
  /// Distance of a box and a ball or capsule. Nothing if they are other shapes, or if the spine meets the box. `p`:
  /// from the ball or capsule to the box, `half`: half of its spine.
  static std::optional<double> gap_to_box(const Part& box, const Pose& pose, const Part& round, const Vec3& p,
                                          const Vec3& half) {
    if (!box.box || !round.spine.is_exact) return std::nullopt;
    const Quat to_box = pose.q_WB.conjugate();
    const double apart = segment_from_box(to_box * -p, to_box * half, *box.box);
    return apart > 0 ? std::optional(apart - round.spine.radius) : std::nullopt;
  }

  static double between(const Part& a, const Pose& pose_a, const Part& b, const Pose& pose_b, double limit_m) {
    const double spheres_apart = (pose_b.p_WB - pose_a.p_WB).norm() - a.radius - b.radius;
    if (spheres_apart > limit_m || (is_ball(a) && is_ball(b))) return spheres_apart;
    const Vec3 p_AB = pose_b.p_WB - pose_a.p_WB;
    const Vec3 half_a = pose_a.q_WB * a.spine.half, half_b = pose_b.q_WB * b.spine.half;
    const double spines_apart = segments_apart(half_a, p_AB, half_b) - a.spine.radius - b.spine.radius;
    if (spines_apart > limit_m || (a.spine.is_exact && b.spine.is_exact)) return spines_apart;
    if (const auto gap = gap_to_box(a, pose_a, b, -p_AB, half_b)) return *gap;
    if (const auto gap = gap_to_box(b, pose_b, a, p_AB, half_a)) return *gap;
    const btTransform X_A = to_bullet(pose_a), X_B = to_bullet(pose_b);
    const double apart = apart_at_least(a, X_A, b, X_B, limit_m);
    return apart > limit_m ? apart : distance(a, X_A, b, X_B, spheres_apart);
  }

  /// The parts of a prototype, made when first asked for, because a scene may get more prototypes. An unknown prototype
  /// counts as a point; only a faulty neighbour could name one.
  const ConvexParts& of(core::PrototypeId prototype) const {
    static const ConvexParts kPoint{};
    if (core::value_of(prototype) >= scene_.prototypes.size()) return kPoint;
    while (prototypes_.size() <= core::value_of(prototype)) {
      const core::Shape& shape = scene_.shapes.at(scene_.prototypes.at(prototypes_.size()).shape).shape;
      prototypes_.push_back({std::visit(MakeParts{}, shape), core::bounding_radius(shape)});
    }
    return prototypes_[core::value_of(prototype)];
  }

  const core::Scene& scene_;
  mutable std::deque<ConvexParts> prototypes_;  // deque: references to entries stay valid
};

}  // namespace

std::unique_ptr<core::ClearanceQuery> make_clearance_query(const core::Scene& scene) {
  return std::make_unique<Query>(scene);
}

}  // namespace aurasim::physics
