// A Bullet world that is set up for equal bits (docs/design.md, "The same bits"), behind a small interface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include "core/body_state.h"
#include "physics/bounds.h"
#include "physics/contact_cache.h"
#include "physics/contact_impulses.h"
#include "physics/first_contacts.h"
#include "physics/prefetch.h"
#include "physics/settings.h"
#include "physics/sleeping_pairs.h"
#include "physics/soft/touch.h"

class btRigidBody;
class btTypedConstraint;

namespace aurasim::physics {

namespace soft {
class Team;
}
class BringsStatics;
struct Coupling;

class DynamicsWorld {
 public:
  DynamicsWorld(const core::Vec3& gravity, const Settings& settings);
  ~DynamicsWorld();

  /// Inserts a body. `rank` > 0 has to be the same in every world; it decides which body of a pair is body0. Insert
  /// bodies in the order of ranks. `collides` false: the body touches nothing.
  void insert(btRigidBody& body, int rank, bool collides = true);
  /// Inserts a static. `start`: its pose at the start of the run.
  void insert_static(btRigidBody& fixed, int rank, const btTransform& start);
  void remove_statics(std::span<btRigidBody* const> fixed);
  /// Calls `statics` before contacts near a place are looked for, and before rays. Null: all statics are here.
  void use(BringsStatics* statics);
  /// True if the box of a body in the broadphase meets `where`.
  bool has_body_near(const Bounds& where) const;
  /// Removes bodies with all their contacts.
  void remove(std::span<btRigidBody* const> bodies);

  /// Updates the bounds of a body that has been moved from outside.
  void move(btRigidBody& body);
  /// Forgets all contacts, and whatever else this world remembers of earlier states. Its bodies, pairs and joints stay.
  void forget_past();

  /// Turns a static of this world into one that moves (physics/moving_static.h).
  void begin_moving(btRigidBody& fixed);
  /// Widens the broadphase's bounds of a static that goes to `until` in the next step, so that they hold its way.
  void bound(btRigidBody& moving_static, const btTransform& until);

  /// Inserts a joint. `order` has to be the same in every world; it decides the order in which the solver sees joints.
  /// If `bodies_collide` is false, the two bodies must not have contacts yet.
  void connect(btTypedConstraint& joint, int order, bool bodies_collide);
  void disconnect(btTypedConstraint& joint);

  /// See RegionWorld::couple().
  void couple(const Coupling& coupling);
  /// See World in physics/stepper.h.
  void expect_contacts_with(std::span<const core::RegionId> regions);

  void step(double substep_s);

  /// See World in physics/stepper.h. Valid until bodies come or go.
  bool knows_moved() const;
  std::span<btRigidBody* const> moved() const;
  std::span<const btRigidBody* const> called() const;
  void add_contacts_of_moved(std::vector<std::pair<int, int>>& contacts) const;
  /// Appends the contacts of two objects.
  void add_contacts(const btRigidBody& a, const btRigidBody& b, std::vector<ContactView>& found) const;
  /// Calls `visit(ContactView)` for each contact, in no order.
  template <class Visit>
  void for_each_contact(Visit&& visit) const {
    for_each_touching(manifolds(), [&](const btPersistentManifold& manifold) { visit(ContactView(manifold)); });
    sleeping_pairs().for_each_contact(visit);
  }

  /// Calls `visit(ContactView, i, j)` for each contact of `bodies`, in no order. `i`, `j`: which of `bodies` its first
  /// and its second body are; bodies.size(): none. Costs nothing for other sleepers.
  template <class Visit>
  void for_each_contact(std::span<const btRigidBody* const> bodies, Visit&& visit) const {
    std::vector<std::pair<const btCollisionObject*, std::size_t>> index;
    for (std::size_t i = 0; i < bodies.size(); ++i) index.emplace_back(bodies[i], i);
    std::ranges::sort(index);
    const auto index_of = [&](const btCollisionObject& object) {
      const auto found = std::ranges::lower_bound(index, &object, {}, [](const auto& entry) { return entry.first; });
      return found != index.end() && found->first == &object ? found->second : bodies.size();
    };
    for_each_touching(manifolds(), [&](const btPersistentManifold& manifold) {
      const std::size_t i = index_of(*manifold.getBody0()), j = index_of(*manifold.getBody1());
      if (i < bodies.size() || j < bodies.size()) visit(ContactView(manifold), i, j);
    });
    for (std::size_t of = 0; of < bodies.size(); ++of) {
      sleeping_pairs().for_each_contact(slot_of(*bodies[of]), [&](const ContactView& contact) {
        const std::size_t i = index_of(contact.body0()), j = index_of(contact.body1());
        if (i >= bodies.size() || j >= bodies.size() || std::min(i, j) == of) visit(contact, i, j);
      });
    }
  }

  /// Makes the manifolds of a pair, even if both bodies sleep, empties them, and lists them in `result`. Others would
  /// not outlive the next collision detection.
  void make_manifolds(btRigidBody& a, btRigidBody& b, std::vector<PartManifold>& result);

  /// Casts a ray and passes `hit` every object on the way that it does not reject.
  void cast(const btVector3& from, const btVector3& to, btCollisionWorld::RayResultCallback& hit) const;

  /// Appends the user indices of bodies whose boxes in the broadphase come within Bounds::kNear_m of `bounds`.
  void find_near(const Bounds& bounds, std::vector<std::uint32_t>& found) const;
  /// The threads that step this world. They rest() between steps.
  soft::Team& team();

  FirstContacts& first_contacts();
  ContactImpulses& contact_impulses();

 private:
  std::span<btPersistentManifold* const> manifolds() const;
  const SleepingPairs& sleeping_pairs() const;
  void forget_whether_they_touch(btTypedConstraint& joint);

  struct Bullet;
  std::unique_ptr<Bullet> bullet_;
};

}  // namespace aurasim::physics
