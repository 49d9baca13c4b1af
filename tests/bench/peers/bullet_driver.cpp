// Bullet as Debian has it, with its defaults: one step of 10 iterations, friction in one direction. It has no threads.
#include <stdexcept>

#include <btBulletDynamicsCommon.h>

#include "driver.h"

namespace {

using peers::ShapeKind;

btScalar scalar(double x) { return static_cast<btScalar>(x); }
btVector3 vector(const peers::Vec3& v) { return {scalar(v.x), scalar(v.y), scalar(v.z)}; }
btTransform transform(const peers::Vec3& p, const peers::Quat& q) {
  return btTransform(btQuaternion(scalar(q.x), scalar(q.y), scalar(q.z), scalar(q.w)), vector(p));
}

std::unique_ptr<btCollisionShape> make_shape(const peers::Shape& s) {
  switch (s.kind) {
    case ShapeKind::kSphere:
      return std::make_unique<btSphereShape>(scalar(s.radius));
    case ShapeKind::kBox:
      return std::make_unique<btBoxShape>(vector(s.half_extents));
    case ShapeKind::kCapsule:
      return std::make_unique<btCapsuleShapeZ>(scalar(s.radius), scalar(s.height));
    case ShapeKind::kPlane:
      return std::make_unique<btStaticPlaneShape>(vector(s.normal), scalar(s.offset));
    case ShapeKind::kHull:
      break;
  }
  auto hull = std::make_unique<btConvexHullShape>();
  for (const peers::Vec3& point : s.points) hull->addPoint(vector(point), false);
  hull->recalcLocalAabb();
  return hull;
}

class World {
 public:
  World(const peers::Scene& scene, int threads) : scene_(scene) {
    if (threads != 1) throw std::runtime_error("Bullet as Debian builds it has one thread");
    world_.setGravity(vector(scene.gravity));
    world_.getSolverInfo().m_restitutionVelocityThreshold = 0;
    for (const peers::Shape& shape : scene.shapes) shapes_.push_back(make_shape(shape));
    for (const peers::Static& s : scene.statics) put_in(0, s.shape, s.material, transform(s.p, s.q));
  }

  ~World() {
    for (auto& joint : joints_) world_.removeConstraint(joint.get());
    for (auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  void add(const peers::Body& b) {
    const peers::Kind& kind = scene_.kinds[b.kind];
    btRigidBody& body = put_in(kind.mass, kind.shape, kind.material, transform(b.p, b.q));
    body.setLinearVelocity(vector(b.v));
    body.setAngularVelocity(vector(b.w));
    if (!scene_.sleeping) body.setActivationState(DISABLE_DEACTIVATION);
  }

  void join() {
    for (const peers::Joint& joint : scene_.joints) {
      btRigidBody& a = body(joint.a);
      btRigidBody& b = body(joint.b);
      const btTransform X_WJ = transform(joint.p, joint.q);
      const btTransform X_AJ = a.getWorldTransform().inverse() * X_WJ, X_BJ = b.getWorldTransform().inverse() * X_WJ;
      if (joint.is_hinge) {
        auto hinge = std::make_unique<btHingeConstraint>(a, b, X_AJ, X_BJ);
        hinge->setLimit(scalar(joint.low), scalar(joint.high));
        joints_.push_back(std::move(hinge));
      } else {
        joints_.push_back(std::make_unique<btPoint2PointConstraint>(a, b, X_AJ.getOrigin(), X_BJ.getOrigin()));
      }
      constexpr bool kDoNotCollide = true;
      world_.addConstraint(joints_.back().get(), kDoNotCollide);
    }
  }

  void step() { world_.stepSimulation(scalar(scene_.step_s), 0); }

  peers::State state(std::size_t index) const {
    const btRigidBody& b = *bodies_[scene_.statics.size() + index];
    const btVector3 p = b.getWorldTransform().getOrigin(), v = b.getLinearVelocity(), w = b.getAngularVelocity();
    const btQuaternion q = b.getWorldTransform().getRotation();
    return {{p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}, {v.x(), v.y(), v.z()}, {w.x(), w.y(), w.z()}};
  }

 private:
  btRigidBody& put_in(double mass, std::size_t shape, std::size_t material, const btTransform& X_WB) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shapes_[shape]->calculateLocalInertia(scalar(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, shapes_[shape].get(), inertia);
    info.m_startWorldTransform = X_WB;
    info.m_friction = scalar(scene_.materials[material].friction);
    info.m_restitution = scalar(scene_.materials[material].restitution);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
    return *bodies_.back();
  }

  btRigidBody& body(std::size_t index) { return *bodies_[scene_.statics.size() + index]; }

  const peers::Scene& scene_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;  ///< the statics first
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

}  // namespace

int main(int argc, char** argv) {
  return peers::drive<World>(argc, argv, "bullet", sizeof(btScalar) == sizeof(double) ? "double" : "single");
}
