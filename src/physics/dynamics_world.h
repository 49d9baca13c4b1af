// A Bullet world that is set up for equal bits (docs/design.md, "The same bits"), and the few things that are done to
// it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include "core/body_state.h"
#include "physics/contact_cache.h"
#include "physics/contact_impulses.h"
#include "physics/first_contacts.h"
#include "physics/settings.h"

class btRigidBody;
class btTypedConstraint;

namespace aurasim::physics {

class DynamicsWorld {
 public:
  DynamicsWorld(const core::Vec3& gravity, const Settings& settings);
  ~DynamicsWorld();

  /// `rank` > 0 is the same in every world and fixes which one of a pair is body0. Nothing else may depend on the
  /// order of insertion, but insert in the order of ranks all the same. Unless it `collides`, it touches nothing.
  void insert(btRigidBody& body, int rank, bool collides = true);
  /// With all contacts.
  void remove(std::span<btRigidBody* const> bodies);

  /// A static that is in the world is from now on one that moves (physics/moving_static.h).
  void begin_moving(btRigidBody& fixed);
  /// Of a static that goes to `until` in the next step: what it may meet on the way.
  void bound(btRigidBody& moving_static, const btTransform& until);

  /// `order` fixes the order in which the solver sees the joints; the same in every world. Unless they collide, the
  /// two bodies may not have contacts yet.
  void connect(btTypedConstraint& joint, int order, bool bodies_collide);
  void disconnect(btTypedConstraint& joint);

  void step(double substep_s);

  std::span<btPersistentManifold* const> manifolds() const;

  /// Makes the manifolds of a pair, even if both bodies sleep, and empties them. `result` names them; any that Bullet
  /// does not make here would not outlive the next collision detection.
  void make_manifolds(btRigidBody& a, btRigidBody& b, std::vector<PartManifold>& result);

  /// Every object on the way that the callback does not turn down is shown to it.
  void cast(const btVector3& from, const btVector3& to, btCollisionWorld::RayResultCallback& hit) const;

  FirstContacts& first_contacts();
  ContactImpulses& contact_impulses();

 private:
  struct Bullet;
  std::unique_ptr<Bullet> bullet_;
};

}  // namespace aurasim::physics
