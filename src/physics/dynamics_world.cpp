#include "physics/dynamics_world.h"

#include <algorithm>
#include <span>

#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/ConstraintSolver/btConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/broadphase.h"
#include "physics/bullet_convert.h"
#include "physics/contact_pairs.h"
#include "physics/dispatcher.h"
#include "physics/inner_edges.h"
#include "physics/made_manifolds.h"
#include "physics/moving_body.h"
#include "physics/moving_static.h"
#include "physics/prefetch.h"
#include "physics/soft/threads.h"
#include "physics/soft/world.h"
#include "physics/solvers.h"
#include "physics/stepper.h"

namespace aurasim::physics {
namespace {

/// Collision group of guests. They touch only bodies that this world hosts.
constexpr int kGuests = 1 << 6;

/// The dispatcher has pools of its own.
btDefaultCollisionConstructionInfo without_pools() {
  btDefaultCollisionConstructionInfo info;
  info.m_defaultMaxPersistentManifoldPoolSize = info.m_defaultMaxCollisionAlgorithmPoolSize = 1;
  return info;
}

}  // namespace

struct DynamicsWorld::Bullet {
  explicit Bullet(const Settings& settings)
      : team(settings.looks_once() ? settings.threads : 1),
        solver(make_solver()),
        world((settings.looks_once() ? make_soft_world : make_stepper)(
            {dispatcher, broadphase, *solver, configuration, first_contacts, contact_impulses, moving_statics, team},
            settings)),
        sums_itself(settings.looks_once()) {}

  soft::Team team;
  btDefaultCollisionConfiguration configuration{without_pools()};
  InnerEdges inner_edges;
  Dispatcher dispatcher{configuration, inner_edges};
  ContactPairs pairs;
  Broadphase broadphase{pairs, team};
  std::unique_ptr<btConstraintSolver> solver;
  FirstContacts first_contacts;
  ContactImpulses contact_impulses;
  std::vector<btRigidBody*> moving_statics;
  std::unique_ptr<World> world;
  bool sums_itself;  ///< the soft step adds contact impulses itself
};

DynamicsWorld::DynamicsWorld(const core::Vec3& gravity, const Settings& settings)
    : bullet_(std::make_unique<Bullet>(settings)) {
  // One query finds one corner of a box on a plane, and a sliding box loses it again in the next substep. Five tilted
  // queries, 72 degrees apart, find all four corners however the box is turned. They are skipped while a manifold has
  // four points.
  bullet_->configuration.setPlaneConvexMultipointIterations(/*numPerturbationIterations=*/5,
                                                            /*minimumPointsPerturbationThreshold=*/4);
  bullet_->world->setGravity(to_bullet(gravity));
}

DynamicsWorld::~DynamicsWorld() {
  while (bullet_->world->getNumConstraints() > 0) {
    bullet_->world->removeConstraint(bullet_->world->getConstraint(bullet_->world->getNumConstraints() - 1));
  }
  btCollisionObjectArray& objects = bullet_->world->getCollisionObjectArray();
  std::vector<btBroadphaseProxy*> proxies;
  for (int i = 0; i < objects.size(); ++i) proxies.push_back(objects[i]->getBroadphaseHandle());
  bullet_->pairs.remove_pairs_of(proxies, bullet_->dispatcher);
  while (objects.size() > 0) bullet_->world->removeCollisionObject(objects[objects.size() - 1]);
}

void DynamicsWorld::insert(btRigidBody& body, int rank, bool collides) {
  bullet_->broadphase.number_next(rank);
  if (is_guest(body)) {
    bullet_->world->addRigidBody(&body, kGuests, btBroadphaseProxy::DefaultFilter);
  } else {
    bullet_->world->addRigidBody(&body);
  }
  if (is_moving_static(body)) begin_moving(body);
  if (!collides) {  // leaves all collision groups, and removes pairs made on insertion
    btBroadphaseProxy* const proxy = body.getBroadphaseHandle();
    proxy->m_collisionFilterGroup = proxy->m_collisionFilterMask = 0;
    bullet_->pairs.remove_pairs_of(std::span(&proxy, 1), bullet_->dispatcher);
  }
  bullet_->world->updateSingleAabb(&body);  // includes the margin, because bounds of sleepers are not updated later
}

void DynamicsWorld::insert_static(btRigidBody& fixed, int rank, const btTransform& start) {
  bullet_->inner_edges.insert(fixed, start);
  insert(fixed, rank);
}

void DynamicsWorld::remove_statics(std::span<btRigidBody* const> fixed) {
  for (const btRigidBody* leaving : fixed) bullet_->inner_edges.remove(*leaving);
  remove(fixed);
}

void DynamicsWorld::use(BringsStatics* statics) { bullet_->broadphase.use(statics); }

bool DynamicsWorld::has_body_near(const Bounds& where) const { return bullet_->broadphase.has_body_near(where); }

void DynamicsWorld::remove(std::span<btRigidBody* const> bodies) {
  std::vector<btBroadphaseProxy*> proxies;
  for (btRigidBody* body : bodies) proxies.push_back(body->getBroadphaseProxy());
  bullet_->pairs.remove_pairs_of(proxies, bullet_->dispatcher);
  for (btRigidBody* body : bodies) {
    if (is_moving_static(*body)) std::erase(bullet_->moving_statics, body);
    bullet_->world->removeRigidBody(body);
  }
}

void DynamicsWorld::move(btRigidBody& body) { bullet_->world->updateSingleAabb(&body); }

void DynamicsWorld::forget_past() {
  bullet_->world->forget_past();
  bullet_->pairs.sleeping().take_all(
      [this](const SleepingPairs::Pair& pair) { bullet_->pairs.addOverlappingPair(pair.proxy0, pair.proxy1); });
  const std::span<btPersistentManifold* const> all = manifolds();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i + kPrefetchDistance < all.size()) prefetch_head(*all[i + kPrefetchDistance]);
    all[i]->clearManifold();
    bullet_->first_contacts.forget(*all[i]);
  }
}

void DynamicsWorld::begin_moving(btRigidBody& fixed) { bullet_->moving_statics.push_back(&fixed); }

void DynamicsWorld::bound(btRigidBody& moving_static, const btTransform& until) {
  const btVector3 margin(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
  btVector3 low, high, low_then, high_then;
  moving_static.getAabb(low, high);
  moving_static.getCollisionShape()->getAabb(until, low_then, high_then);
  low.setMin(low_then), high.setMax(high_then);
  bullet_->broadphase.setAabb(moving_static.getBroadphaseProxy(), low - margin, high + margin, &bullet_->dispatcher);
}

void DynamicsWorld::connect(btTypedConstraint& joint, int order, bool bodies_collide) {
  joint.setUserConstraintType(order);
  bullet_->world->addConstraint(&joint, !bodies_collide);
  forget_whether_they_touch(joint);
}

void DynamicsWorld::disconnect(btTypedConstraint& joint) {
  bullet_->world->removeConstraint(&joint);
  forget_whether_they_touch(joint);
}

/// The soft step notes in a pair whether joints keep its bodies from touching (soft/contacts.cpp).
void DynamicsWorld::forget_whether_they_touch(btTypedConstraint& joint) {
  btBroadphaseProxy* const a = joint.getRigidBodyA().getBroadphaseProxy();
  btBroadphaseProxy* const b = joint.getRigidBodyB().getBroadphaseProxy();
  if (a == nullptr || b == nullptr) return;
  if (btBroadphasePair* const pair = bullet_->pairs.findPair(a, b)) pair->m_internalInfo1 = nullptr;
}

void DynamicsWorld::couple(const Coupling& coupling) { bullet_->world->couple(coupling); }

void DynamicsWorld::expect_contacts_with(std::span<const core::RegionId> regions) {
  bullet_->world->expect_contacts_with(regions);
}

void DynamicsWorld::step(double substep_s) {
  const btScalar dt = static_cast<btScalar>(substep_s);
  bullet_->world->stepSimulation(dt, /*maxSubSteps=*/0, dt);
  if (bullet_->contact_impulses.wanted() && !bullet_->sums_itself) bullet_->contact_impulses.look(manifolds());
}

std::span<btPersistentManifold* const> DynamicsWorld::manifolds() const { return manifolds_of(bullet_->dispatcher); }

bool DynamicsWorld::knows_moved() const { return bullet_->world->knows_moved(); }

std::span<btRigidBody* const> DynamicsWorld::moved() const { return bullet_->world->moved(); }

std::span<const btRigidBody* const> DynamicsWorld::called() const { return bullet_->world->called(); }

void DynamicsWorld::add_contacts_of_moved(std::vector<std::pair<int, int>>& contacts) const {
  bullet_->world->add_contacts_of_moved(contacts);
}

const SleepingPairs& DynamicsWorld::sleeping_pairs() const { return bullet_->pairs.sleeping(); }

void DynamicsWorld::add_contacts(const btRigidBody& a, const btRigidBody& b, std::vector<ContactView>& found) const {
  const auto proxy = [](const btRigidBody& body) { return const_cast<btBroadphaseProxy*>(body.getBroadphaseProxy()); };
  if (proxy(a) == nullptr || proxy(b) == nullptr) return;  // a static that is gone
  sleeping_pairs().for_each_contact(*proxy(a), *proxy(b),
                                    [&](const ContactView& contact) { found.push_back(contact); });
  const btBroadphasePair* const pair = bullet_->pairs.findPair(proxy(a), proxy(b));
  if (pair == nullptr || pair->m_algorithm == nullptr) return;
  btManifoldArray manifolds;
  pair->m_algorithm->getAllContactManifolds(manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    if (manifolds[i]->getNumContacts() > 0) found.emplace_back(*manifolds[i]);
  }
}

void DynamicsWorld::make_manifolds(btRigidBody& a, btRigidBody& b, std::vector<PartManifold>& result) {
  result.clear();
  bullet_->pairs.sleeping().remove(*a.getBroadphaseProxy(), *b.getBroadphaseProxy());
  btBroadphasePair* const pair = bullet_->pairs.addOverlappingPair(a.getBroadphaseProxy(), b.getBroadphaseProxy());
  if (pair == nullptr) return;
  physics::make_manifolds(*pair, bullet_->dispatcher, bullet_->world->getDispatchInfo(), result);
}

void DynamicsWorld::cast(const btVector3& from, const btVector3& to, btCollisionWorld::RayResultCallback& hit) const {
  bullet_->world->rayTest(from, to, hit);
}

void DynamicsWorld::find_near(const Bounds& bounds, std::vector<std::uint32_t>& found) const {
  struct Finder final : btBroadphaseAabbCallback {
    Finder(const Bounds& where_in, std::vector<std::uint32_t>& found_in) : where(where_in), found(found_in) {}
    bool process(const btBroadphaseProxy* proxy) override {
      const int index = static_cast<const btCollisionObject*>(proxy->m_clientObject)->getUserIndex();
      if (index >= 0 && bounds_of(*proxy).is_near(where)) found.push_back(static_cast<std::uint32_t>(index));
      return true;
    }
    const Bounds& where;
    std::vector<std::uint32_t>& found;
  };
  Finder finder(bounds, found);
  const Bounds wide = bounds.grown(2 * Bounds::kNear_m);  // the tree's boxes are not rounded as is_near() rounds
  bullet_->broadphase.aabbTest(wide.low, wide.high, finder);
}

soft::Team& DynamicsWorld::team() { return bullet_->team; }

FirstContacts& DynamicsWorld::first_contacts() { return bullet_->first_contacts; }

ContactImpulses& DynamicsWorld::contact_impulses() { return bullet_->contact_impulses; }

}  // namespace aurasim::physics
