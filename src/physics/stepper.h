// Bullet's own step, with what we do otherwise: collision detection and solver in every substep.
#pragma once

#include <memory>
#include <vector>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace aurasim::physics {

class ContactImpulses;
class FirstContacts;
struct Settings;

/// What a world works with; all of it outlives the world.
struct WorldParts {
  btDispatcher& dispatcher;
  btBroadphaseInterface& broadphase;
  btConstraintSolver& solver;
  btCollisionConfiguration& configuration;
  FirstContacts& first_contacts;
  ContactImpulses& contact_impulses;
  const std::vector<btRigidBody*>& moving_statics;
};

std::unique_ptr<btDiscreteDynamicsWorld> make_stepper(const WorldParts& parts, const Settings& settings);

}  // namespace aurasim::physics
