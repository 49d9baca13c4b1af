#include "physics/dynamics_world.h"

#include <algorithm>
#include <optional>
#include <span>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletDynamics/ConstraintSolver/btConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"
#include "physics/contact_islands.h"
#include "physics/contact_pairs.h"
#include "physics/dispatcher.h"
#include "physics/free_rotation.h"
#include "physics/prefetch.h"
#include "physics/soft_step.h"
#include "physics/solvers.h"

namespace aurasim::physics {
namespace {

/// Bullet's world with our islands, and a look at the contacts before they are solved.
class Stepper final : public btDiscreteDynamicsWorld {
 public:
  Stepper(btDispatcher& dispatcher, btBroadphaseInterface& broadphase, btConstraintSolver& solver,
          btCollisionConfiguration& configuration)
      : btDiscreteDynamicsWorld(&dispatcher, &broadphase, &solver, &configuration) {
    m_islandManager->~btSimulationIslandManager();
    btAlignedFree(m_islandManager);
    islands_ = new (btAlignedAlloc(sizeof(ContactIslands), 16)) ContactIslands;
    m_islandManager = islands_;  // which Bullet destroys
  }

  void solveConstraints(btContactSolverInfo& info) override {
    first_contacts_.look(*getDispatcher(), *getPairCache());
    const auto joints = std::span(m_constraints.size() > 0 ? &m_constraints[0] : nullptr,
                                  static_cast<std::size_t>(m_constraints.size()));
    if (soft_step_) {
      islands_->solve(*this, joints, *soft_step_);
      return;
    }
    m_constraintSolver->prepareSolve(getNumCollisionObjects(), getDispatcher()->getNumManifolds());
    islands_->solve(*this, joints, *m_constraintSolver, info);
    m_constraintSolver->allSolved(info, nullptr);
  }

  /// Bullet's contacts ahead of time live in no pair's cache, so no hand-off could carry them. Fast bodies are stopped
  /// at what is in their way all the same.
  void createPredictiveContacts(btScalar) override {}

  /// Bullet moves all bodies; those that do not turn evenly are then turned as they should.
  void integrateTransforms(btScalar dt) override {
    if (soft_step_) return;  // has moved them
    if (sweeps_) sort_by_rank();
    tumbling_.clear();
    for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i) {
      btRigidBody& body = *m_nonStaticRigidBodies[i];
      if (!body.isActive()) continue;
      const std::optional<core::Vec3> inertia = tumbling_inertia(body);
      if (!inertia) continue;
      const Rotation now{from_bullet(body.getWorldTransform().getBasis()), from_bullet(body.getAngularVelocity())};
      tumbling_.push_back({&body, rotate_freely(now, *inertia, static_cast<double>(dt))});
    }
    btDiscreteDynamicsWorld::integrateTransforms(dt);
    for (const Tumbling& t : tumbling_) {
      t.body->setAngularVelocity(to_bullet(t.after.w_WB));
      t.body->setCenterOfMassTransform(btTransform(to_bullet(t.after.R_WB), t.body->getWorldTransform().getOrigin()));
    }
  }

  FirstContacts& first_contacts() { return first_contacts_; }
  void stop_fast_bodies() { sweeps_ = true; }
  void use_soft_step(double step_s, int substeps) { soft_step_ = std::make_unique<SoftStep>(step_s, substeps); }

 private:
  /// A fast body stops at others where they are at that moment: some have been moved already. Which, may not depend on
  /// the order in which they came here.
  void sort_by_rank() {
    const auto rank = [](const btRigidBody* body) { return body->getBroadphaseProxy()->m_uniqueId; };
    btRigidBody** const first = m_nonStaticRigidBodies.size() > 0 ? &m_nonStaticRigidBodies[0] : nullptr;
    const std::span<btRigidBody*> bodies(first, static_cast<std::size_t>(m_nonStaticRigidBodies.size()));
    if (!std::ranges::is_sorted(bodies, {}, rank)) std::ranges::sort(bodies, {}, rank);
  }

  struct Tumbling {
    btRigidBody* body;
    Rotation after;
  };

  bool sweeps_ = false;
  std::unique_ptr<SoftStep> soft_step_;
  ContactIslands* islands_ = nullptr;
  FirstContacts first_contacts_;
  std::vector<Tumbling> tumbling_;
};

/// Makes a body awake for as long as this lives: Bullet does not look at pairs of sleepers.
class Awake {
 public:
  explicit Awake(btCollisionObject& body) : body_(body), state_(body.getActivationState()) {
    body_.forceActivationState(ACTIVE_TAG);
  }
  ~Awake() { body_.forceActivationState(state_); }
  Awake(const Awake&) = delete;
  Awake& operator=(const Awake&) = delete;

 private:
  btCollisionObject& body_;
  int state_;
};

/// What tells the contacts of a new pair. For boxes and spheres it has a manifold from the beginning.
void make_algorithm(btBroadphasePair& pair, btDispatcher& dispatcher) {
  auto& object0 = *static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  auto& object1 = *static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  if (!dispatcher.needsCollision(&object0, &object1)) return;
  const auto wrap = [](const btCollisionObject& object) {
    return btCollisionObjectWrapper(nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1, -1);
  };
  const btCollisionObjectWrapper wrap0 = wrap(object0);
  const btCollisionObjectWrapper wrap1 = wrap(object1);
  pair.m_algorithm = dispatcher.findAlgorithm(&wrap0, &wrap1, nullptr, BT_CONTACT_POINT_ALGORITHMS);
}

}  // namespace

struct DynamicsWorld::Bullet {
  explicit Bullet(Solver kind) : solver(make_solver(kind)) {}

  btDefaultCollisionConfiguration configuration;
  Dispatcher dispatcher{configuration};
  ContactPairs pairs;
  btDbvtBroadphase broadphase{&pairs};
  std::unique_ptr<btConstraintSolver> solver;
  Stepper world{dispatcher, broadphase, *solver, configuration};
};

DynamicsWorld::DynamicsWorld(const core::Vec3& gravity, const Settings& settings)
    : bullet_(std::make_unique<Bullet>(settings.solver)) {
  bullet_->broadphase.m_cupdates = 100;  // per cent of the pairs checked in each substep: stale ones cost time
  // One look finds one corner of a box on a plane, and slides lose it again in the next substep. Five looks, tilted
  // every 72 degrees, find all four, however the box is turned; while it has four they are left out.
  bullet_->configuration.setPlaneConvexMultipointIterations(/*numPerturbationIterations=*/5,
                                                            /*minimumPointsPerturbationThreshold=*/4);
  bullet_->world.setGravity(to_bullet(gravity));
  bullet_->world.getSolverInfo().m_numIterations = settings.solver_iterations;
  if (settings.friction_directions > 1) {
    bullet_->world.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  }
  if (settings.looks_once()) bullet_->world.use_soft_step(settings.step_s, settings.substeps);
  if (settings.continuous) bullet_->world.stop_fast_bodies();
  bullet_->world.getSolverInfo().m_erp2 = static_cast<btScalar>(settings.contact_erp);
}

DynamicsWorld::~DynamicsWorld() {
  while (bullet_->world.getNumConstraints() > 0) {
    bullet_->world.removeConstraint(bullet_->world.getConstraint(bullet_->world.getNumConstraints() - 1));
  }
  btCollisionObjectArray& objects = bullet_->world.getCollisionObjectArray();
  std::vector<btBroadphaseProxy*> proxies;
  for (int i = 0; i < objects.size(); ++i) proxies.push_back(objects[i]->getBroadphaseHandle());
  bullet_->pairs.remove_pairs_of(proxies, bullet_->dispatcher);
  while (objects.size() > 0) bullet_->world.removeCollisionObject(objects[objects.size() - 1]);
}

void DynamicsWorld::insert(btRigidBody& body, int rank) {
  bullet_->broadphase.m_gid = rank - 1;  // the next proxy gets the id after this one
  bullet_->world.addRigidBody(&body);
}

void DynamicsWorld::remove(std::span<btRigidBody* const> bodies) {
  std::vector<btBroadphaseProxy*> proxies;
  for (btRigidBody* body : bodies) proxies.push_back(body->getBroadphaseProxy());
  bullet_->pairs.remove_pairs_of(proxies, bullet_->dispatcher);
  for (btRigidBody* body : bodies) bullet_->world.removeRigidBody(body);
}

void DynamicsWorld::connect(btTypedConstraint& joint, int order, bool bodies_collide) {
  joint.setUserConstraintId(order);
  bullet_->world.addConstraint(&joint, !bodies_collide);
}

void DynamicsWorld::disconnect(btTypedConstraint& joint) { bullet_->world.removeConstraint(&joint); }

void DynamicsWorld::step(double substep_s) {
  const btScalar dt = static_cast<btScalar>(substep_s);
  bullet_->world.stepSimulation(dt, /*maxSubSteps=*/0, dt);
}

std::span<btPersistentManifold* const> DynamicsWorld::manifolds() const { return manifolds_of(bullet_->dispatcher); }

void DynamicsWorld::make_manifolds(btRigidBody& a, btRigidBody& b, std::vector<PartManifold>& result) {
  result.clear();
  const Awake awake(a.isStaticObject() ? b : a);
  btBroadphasePair* const pair = bullet_->pairs.addOverlappingPair(a.getBroadphaseProxy(), b.getBroadphaseProxy());
  if (pair == nullptr) return;
  if (pair->m_algorithm == nullptr) make_algorithm(*pair, bullet_->dispatcher);
  collect_manifolds(*pair, result);
  // A look at the shapes would be most of the work of a hand-off. Of compounds, only some parts have their manifolds.
  if (result.empty() || result.front().parts != Parts{}) {
    btCollisionDispatcher::defaultNearCallback(*pair, bullet_->dispatcher, bullet_->world.getDispatchInfo());
    collect_manifolds(*pair, result);
  }
  for (const PartManifold& made : result) made.manifold->clearManifold();
}

void DynamicsWorld::cast(const btVector3& from, const btVector3& to, btCollisionWorld::RayResultCallback& hit) const {
  bullet_->world.rayTest(from, to, hit);
}

FirstContacts& DynamicsWorld::first_contacts() { return bullet_->world.first_contacts(); }

}  // namespace aurasim::physics
