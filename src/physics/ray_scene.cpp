#include "physics/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include "physics/bullet_convert.h"
#include "physics/shapes.h"
#include "physics/timeline.h"

namespace aurasim::physics {
namespace {

/// Bounding spheres, which exclude targets that a ray cannot meet, are enlarged by this.
constexpr double kSlack_m = 0.01;

/// Past poses of statics that orders have moved are remembered for so many states.
constexpr core::Step kRemembered = 600;

/// An object that rays may hit. The sensor's origin is Bullet's origin.
struct Target {
  core::ObjectRef ref = 0;
  const btCollisionShape* shape = nullptr;
  btTransform pose;
  core::Vec3 p = core::Vec3::Zero();  ///< position of its origin
  double radius_m = 0;                ///< bounding radius around its origin; may be infinite
};

/// Keeps the nearest hit. Of two at the same distance the lower ObjectRef wins; Bullet's own callback would keep the
/// first.
class Nearest final : public btCollisionWorld::RayResultCallback {
 public:
  core::ObjectRef testing = 0;
  std::optional<core::ObjectRef> object;
  btVector3 normal{0, 0, 0};
  btScalar fraction = 1;

  btScalar addSingleResult(btCollisionWorld::LocalRayResult& found, bool normal_is_in_world) override {
    const bool is_nearer =
        !object || found.m_hitFraction < fraction || (found.m_hitFraction == fraction && testing < *object);
    if (!is_nearer) return m_closestHitFraction;
    object = testing;
    fraction = found.m_hitFraction;
    m_collisionObject = found.m_collisionObject;
    m_closestHitFraction = std::nextafter(fraction, std::numeric_limits<btScalar>::max());
    normal = normal_is_in_world ? found.m_hitNormalLocal
                                : m_collisionObject->getWorldTransform().getBasis() * found.m_hitNormalLocal;
    return m_closestHitFraction;
  }
};

/// May a ray from the origin in `direction` meet the target's bounding sphere within `farthest_m`?
bool may_meet(const Target& target, const core::Vec3& direction, double farthest_m) {
  if (!std::isfinite(target.radius_m)) return true;
  const double radius = target.radius_m + kSlack_m;
  const double along = target.p.dot(direction);
  if (along < -radius || along - radius > farthest_m) return false;
  return target.p.squaredNorm() - along * along <= radius * radius;
}

}  // namespace

class RayScene::Impl {
 public:
  Impl(const core::Scene& scene_in, double step_s_in) : scene(scene_in), step_s(step_s_in), shapes(scene_in) {
    measure();
  }

  void measure() {
    for (std::size_t i = radii.size(); i < scene.shapes.size(); ++i) {
      radii.push_back(core::bounding_radius(scene.shapes[i].shape));
    }
    for (const core::Prototype& prototype : scene.prototypes) largest = std::max(largest, radii[prototype.shape]);
  }

  std::vector<Target> targets(core::Step step, std::span<const PlacedBody> bodies, const RayFan& fan) const;
  void add(core::ObjectRef ref, std::uint32_t shape, const core::Pose& X_W, const RayFan& fan,
           std::vector<Target>& to) const;

  const core::Scene& scene;
  double step_s;
  ShapeSet shapes;
  Timeline timeline;
  std::vector<double> radii;  ///< by shape of Scene::shapes
  double largest = 0;
};

RayScene::RayScene(const core::Scene& scene, double step_s) : impl_(std::make_unique<Impl>(scene, step_s)) {}

RayScene::~RayScene() = default;

void RayScene::add(const core::Order& order) {
  impl_->shapes.extend(impl_->scene);
  impl_->measure();
  if (core::body_of(order.action)) return;
  impl_->timeline.add(order);
  impl_->timeline.forget_before(order.at_step - kRemembered);
}

double RayScene::largest_radius_m() const { return impl_->largest; }

void RayScene::Impl::add(core::ObjectRef ref, std::uint32_t shape, const core::Pose& X_W, const RayFan& fan,
                         std::vector<Target>& to) const {
  const core::Vec3 p = X_W.p_WB - fan.X_WS.p_WB;
  if (p.norm() - radii[shape] > fan.range_m + kSlack_m) return;
  to.push_back({ref, shapes.shape(shape), to_bullet(core::Pose{p, X_W.q_WB}), p, radii[shape]});
}

std::vector<Target> RayScene::Impl::targets(core::Step step, std::span<const PlacedBody> bodies,
                                            const RayFan& fan) const {
  std::vector<Target> all;
  for (std::size_t i = 0; i < scene.statics.size(); ++i) {
    if (!timeline.stands(static_cast<std::uint32_t>(i), step)) continue;
    const core::StaticId id{static_cast<std::uint32_t>(i)};
    add(core::ref_of(id), scene.statics.shape(i), timeline.moves().pose(scene.statics, id, step, step_s), fan, all);
  }
  for (const PlacedBody& body : bodies) {
    if (body.id == fan.carrier || core::value_of(body.prototype) >= scene.prototypes.size()) continue;
    add(core::ref_of(body.id), scene.prototypes[core::value_of(body.prototype)].shape, body.pose, fan, all);
  }
  return all;
}

std::vector<RayHit> RayScene::cast(core::Step step, std::span<const PlacedBody> bodies, const RayFan& fan) const {
  const std::vector<Target> targets = impl_->targets(step, bodies, fan);
  const core::Quat q_WS = fan.X_WS.q_WB.normalized();
  btCollisionObject object;  // dummy that Bullet's functions require
  std::vector<RayHit> hits;
  hits.reserve(fan.directions.size());
  for (const core::Vec3& direction_S : fan.directions) {
    const core::Vec3 direction = q_WS * direction_S;
    const btTransform from = btTransform::getIdentity();
    const btTransform to(btMatrix3x3::getIdentity(), to_bullet(core::Vec3(fan.range_m * direction)));
    Nearest nearest;
    for (const Target& target : targets) {
      if (!may_meet(target, direction, static_cast<double>(nearest.fraction) * fan.range_m + kSlack_m)) continue;
      nearest.testing = target.ref;
      object.setWorldTransform(target.pose);
      btCollisionWorld::rayTestSingle(from, to, &object, target.shape, target.pose, nearest);
    }
    RayHit& hit = hits.emplace_back();
    if (!nearest.object) continue;
    hit.object = nearest.object;
    hit.distance_m = static_cast<double>(nearest.fraction) * fan.range_m;
    hit.p_W = fan.X_WS.p_WB + hit.distance_m * direction;
    hit.normal_W = from_bullet(nearest.normal);
  }
  return hits;
}

}  // namespace aurasim::physics
