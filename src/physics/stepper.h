// Bullet's own step with our changes: collision detection and solver run in every substep.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include "core/ids.h"

namespace aurasim::physics {

class ContactImpulses;
class FirstContacts;
namespace soft {
class Team;
}
struct Coupling;
struct Settings;

/// The parts that a world uses; all have to outlive it.
struct WorldParts {
  btDispatcher& dispatcher;
  btBroadphaseInterface& broadphase;
  btConstraintSolver& solver;
  btCollisionConfiguration& configuration;
  FirstContacts& first_contacts;
  ContactImpulses& contact_impulses;
  const std::vector<btRigidBody*>& moving_statics;
  soft::Team& team;
};

/// Bullet's world, as each solver extends it.
class World : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

  /// Forgets what this world remembers of earlier states. Its bodies, pairs and joints stay.
  virtual void forget_past() {}

  /// True if only bodies of moved(), and their contacts, and bodies of called() may have changed in the last step.
  virtual bool knows_moved() const { return false; }
  virtual std::span<btRigidBody* const> moved() const { return {}; }
  /// Sleepers of which nothing has changed but when they wake.
  virtual std::span<const btRigidBody* const> called() const { return {}; }
  /// Appends the pairs of objects, by user index and in ascending order, that are in contact and of which one is among
  /// moved(). A pair may come more than once.
  virtual void add_contacts_of_moved(std::vector<std::pair<int, int>>&) const {}
  /// See RegionWorld::couple(). Throws std::invalid_argument if the solver cannot.
  virtual void couple(const Coupling& coupling);
  /// Names the regions that may have contacts in common with this one in the next step. Precondition: couple().
  virtual void expect_contacts_with(std::span<const core::RegionId>) {}
};

std::unique_ptr<World> make_stepper(const WorldParts& parts, const Settings& settings);

}  // namespace aurasim::physics
