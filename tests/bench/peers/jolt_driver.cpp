// Jolt with its defaults: one collision step, 10 velocity and 2 position iterations.
// clang-format off
#include <Jolt/Jolt.h> // before all others of Jolt
// clang-format on
#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/JobSystemThreadPool.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/GroupFilter.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/CapsuleShape.h>
#include <Jolt/Physics/Collision/Shape/ConvexHullShape.h>
#include <Jolt/Physics/Collision/Shape/PlaneShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/Constraints/HingeConstraint.h>
#include <Jolt/Physics/Constraints/PointConstraint.h>
#include <Jolt/Physics/PhysicsSettings.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/RegisterTypes.h>

#include "driver.h"

namespace {

using peers::ShapeKind;

JPH::Vec3 vector(const peers::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
JPH::Quat quaternion(const peers::Quat& q) {
  return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
}
peers::Vec3 vector(JPH::Vec3 v) { return {v.GetX(), v.GetY(), v.GetZ()}; }

/// Statics and bodies, in the broadphase and in its filters.
constexpr JPH::ObjectLayer kFixed = 0, kMoving = 1;

struct Layers final : JPH::BroadPhaseLayerInterface {
  JPH::uint GetNumBroadPhaseLayers() const override { return 2; }
  JPH::BroadPhaseLayer GetBroadPhaseLayer(JPH::ObjectLayer layer) const override {
    return JPH::BroadPhaseLayer(static_cast<JPH::uint8>(layer));
  }
#if defined(JPH_EXTERNAL_PROFILE) || defined(JPH_PROFILE_ENABLED)
  const char* GetBroadPhaseLayerName(JPH::BroadPhaseLayer layer) const override {
    return layer == JPH::BroadPhaseLayer(kMoving) ? "moving" : "fixed";
  }
#endif
};
struct MovesOrMeetsMoving final : JPH::ObjectVsBroadPhaseLayerFilter {
  bool ShouldCollide(JPH::ObjectLayer a, JPH::BroadPhaseLayer b) const override {
    return a == kMoving || b == JPH::BroadPhaseLayer(kMoving);
  }
};
struct OneMoves final : JPH::ObjectLayerPairFilter {
  bool ShouldCollide(JPH::ObjectLayer a, JPH::ObjectLayer b) const override { return a == kMoving || b == kMoving; }
};

/// Bodies that a joint holds together do not collide; a body's subgroup is its number.
class NotJoined final : public JPH::GroupFilter {
 public:
  explicit NotJoined(const peers::Scene& scene) : partners_(scene.bodies.size()) {
    for (const peers::Joint& joint : scene.joints) {
      partners_[joint.a].push_back(static_cast<JPH::CollisionGroup::SubGroupID>(joint.b));
      partners_[joint.b].push_back(static_cast<JPH::CollisionGroup::SubGroupID>(joint.a));
    }
  }
  bool CanCollide(const JPH::CollisionGroup& a, const JPH::CollisionGroup& b) const override {
    for (const auto partner : partners_[a.GetSubGroupID()]) {
      if (partner == b.GetSubGroupID()) return false;
    }
    return true;
  }

 private:
  std::vector<std::vector<JPH::CollisionGroup::SubGroupID>> partners_;
};

template <float (JPH::Body::*quantity)() const>
float product(const JPH::Body& a, const JPH::SubShapeID&, const JPH::Body& b, const JPH::SubShapeID&) {
  return (a.*quantity)() * (b.*quantity)();
}

/// What all of Jolt needs first.
struct Library {
  Library() {
    JPH::RegisterDefaultAllocator();
    JPH::Factory::sInstance = new JPH::Factory;
    JPH::RegisterTypes();
  }
  ~Library() {
    JPH::UnregisterTypes();
    delete JPH::Factory::sInstance;
    JPH::Factory::sInstance = nullptr;
  }
};

class World {
 public:
  World(const peers::Scene& scene, int threads) : scene_(scene) {
    if (threads > 1) {
      jobs_ = std::make_unique<JPH::JobSystemThreadPool>(JPH::cMaxPhysicsJobs, JPH::cMaxPhysicsBarriers, threads - 1);
    } else {
      jobs_ = std::make_unique<JPH::JobSystemSingleThreaded>(JPH::cMaxPhysicsJobs);
    }
    const auto count = static_cast<JPH::uint>(scene.bodies.size() + scene.statics.size());
    world_.Init(count + 16, 0, std::max(262144u, 8 * count), std::max(131072u, 8 * count), layers_, moves_, one_moves_);
    JPH::PhysicsSettings settings = world_.GetPhysicsSettings();
    settings.mAllowSleeping = scene.sleeping;
    settings.mMinVelocityForRestitution = 0;
    world_.SetPhysicsSettings(settings);
    world_.SetGravity(vector(scene.gravity));
    world_.SetCombineFriction(product<&JPH::Body::GetFriction>);
    world_.SetCombineRestitution(product<&JPH::Body::GetRestitution>);
    if (!scene.joints.empty()) not_joined_ = new NotJoined(scene);
    for (const peers::Shape& shape : scene.shapes) shapes_.push_back(make_shape(shape));
    for (const peers::Static& s : scene.statics) {
      put_in(settings_of(s.shape, s.material, s.p, s.q, JPH::EMotionType::Static), JPH::EActivation::DontActivate);
    }
  }

  void add(const peers::Body& b) {
    const peers::Kind& kind = scene_.kinds[b.kind];
    JPH::BodyCreationSettings body = settings_of(kind.shape, kind.material, b.p, b.q, JPH::EMotionType::Dynamic);
    body.mLinearDamping = body.mAngularDamping = 0;
    body.mLinearVelocity = vector(b.v);
    body.mAngularVelocity = vector(b.w);
    body.mOverrideMassProperties = JPH::EOverrideMassProperties::CalculateInertia;
    body.mMassPropertiesOverride.mMass = static_cast<float>(kind.mass);
    if (not_joined_) {
      body.mCollisionGroup = {not_joined_, 0, static_cast<JPH::CollisionGroup::SubGroupID>(bodies_.size())};
    }
    bodies_.push_back(put_in(body, JPH::EActivation::Activate));
  }

  void join() {
    for (const peers::Joint& joint : scene_.joints) world_.AddConstraint(make_joint(joint));
    world_.OptimizeBroadPhase();
  }

  void step() {
    const JPH::EPhysicsUpdateError error = world_.Update(static_cast<float>(scene_.step_s), 1, &memory_, jobs_.get());
    if (error != JPH::EPhysicsUpdateError::None) throw std::runtime_error("a limit of Jolt's was too low");
  }

  peers::State state(std::size_t index) const {
    const JPH::BodyInterface& all = world_.GetBodyInterface();
    const JPH::BodyID id = bodies_[index];
    const std::size_t shape = scene_.kinds[scene_.bodies[index].kind].shape;
    const JPH::Quat q = all.GetRotation(id) * turn_of(shape).Conjugated();
    return {vector(JPH::Vec3(all.GetPosition(id))),
            {q.GetW(), q.GetX(), q.GetY(), q.GetZ()},
            vector(all.GetLinearVelocity(id)),
            vector(all.GetAngularVelocity(id))};
  }

 private:
  /// Edges are rounded by Jolt's own radius where the shape is thick enough for it.
  static JPH::ShapeRefC make_shape(const peers::Shape& s) {
    const auto radius = static_cast<float>(s.radius), half = static_cast<float>(s.height / 2);
    if (s.kind == ShapeKind::kSphere) return new JPH::SphereShape(radius);
    if (s.kind == ShapeKind::kCapsule) return new JPH::CapsuleShape(half, radius);
    if (s.kind == ShapeKind::kPlane) {
      constexpr float kWide = 5000;
      return new JPH::PlaneShape(JPH::Plane(vector(s.normal), -static_cast<float>(s.offset)), nullptr, kWide);
    }
    if (s.kind == ShapeKind::kBox) {
      const JPH::Vec3 half_extents = vector(s.half_extents);
      const float rounding = std::min(JPH::cDefaultConvexRadius, 0.5f * half_extents.ReduceMin());
      return new JPH::BoxShape(half_extents, rounding);
    }
    JPH::Array<JPH::Vec3> points;
    for (const peers::Vec3& point : s.points) points.push_back(vector(point));
    const JPH::ShapeSettings::ShapeResult hull = JPH::ConvexHullShapeSettings(points).Create();
    if (hull.HasError()) throw std::runtime_error(hull.GetError().c_str());
    return hull.Get();
  }

  /// Jolt's capsules stand along y.
  JPH::Quat turn_of(std::size_t shape) const {
    return scene_.shapes[shape].kind == ShapeKind::kCapsule
               ? JPH::Quat::sRotation(JPH::Vec3::sAxisX(), 0.5f * JPH::JPH_PI)
               : JPH::Quat::sIdentity();
  }

  JPH::BodyCreationSettings settings_of(std::size_t shape, std::size_t material, const peers::Vec3& p,
                                        const peers::Quat& q, JPH::EMotionType motion) const {
    JPH::BodyCreationSettings body(shapes_[shape], JPH::RVec3(vector(p)), quaternion(q) * turn_of(shape), motion,
                                   motion == JPH::EMotionType::Static ? kFixed : kMoving);
    body.mFriction = static_cast<float>(scene_.materials[material].friction);
    body.mRestitution = static_cast<float>(scene_.materials[material].restitution);
    return body;
  }

  JPH::BodyID put_in(const JPH::BodyCreationSettings& body, JPH::EActivation activation) {
    return world_.GetBodyInterface().CreateAndAddBody(body, activation);
  }

  /// Its angles are those of its second body relative to its first.
  JPH::Constraint* make_joint(const peers::Joint& joint) {
    const JPH::BodyLockWrite first(world_.GetBodyLockInterfaceNoLock(), bodies_[joint.b]);
    const JPH::BodyLockWrite second(world_.GetBodyLockInterfaceNoLock(), bodies_[joint.a]);
    if (!joint.is_hinge) {
      JPH::PointConstraintSettings ball;
      ball.mPoint1 = ball.mPoint2 = JPH::RVec3(vector(joint.p));
      return ball.Create(first.GetBody(), second.GetBody());
    }
    JPH::HingeConstraintSettings hinge;
    hinge.mPoint1 = hinge.mPoint2 = JPH::RVec3(vector(joint.p));
    hinge.mHingeAxis1 = hinge.mHingeAxis2 = quaternion(joint.q).RotateAxisZ();
    hinge.mNormalAxis1 = hinge.mNormalAxis2 = quaternion(joint.q).RotateAxisX();
    hinge.mLimitsMin = static_cast<float>(joint.low);
    hinge.mLimitsMax = static_cast<float>(joint.high);
    return hinge.Create(first.GetBody(), second.GetBody());
  }

  Library library_;
  const peers::Scene& scene_;
  JPH::TempAllocatorImpl memory_{1u << 30};
  std::unique_ptr<JPH::JobSystem> jobs_;
  Layers layers_;
  MovesOrMeetsMoving moves_;
  OneMoves one_moves_;
  JPH::PhysicsSystem world_;
  std::vector<JPH::ShapeRefC> shapes_;
  JPH::Ref<NotJoined> not_joined_;
  std::vector<JPH::BodyID> bodies_;
};

}  // namespace

int main(int argc, char** argv) { return peers::drive<World>(argc, argv, "jolt", "single"); }
