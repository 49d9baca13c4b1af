#include "physics/stepper.h"

#include <algorithm>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"
#include "physics/contact_islands.h"
#include "physics/first_contacts.h"
#include "physics/free_rotation.h"
#include "physics/prefetch.h"
#include "physics/settings.h"

namespace aurasim::physics {
namespace {

/// Bullet's world with our islands. First contacts are noted before contacts are solved.
class Stepper final : public World {
 public:
  Stepper(const WorldParts& parts, const Settings& settings)
      : World(&parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration),
        first_contacts_(parts.first_contacts),
        sweeps_(settings.continuous) {
    getSolverInfo().m_numIterations = settings.solver_iterations;
    getSolverInfo().m_erp2 = static_cast<btScalar>(settings.contact_erp);
    if (settings.friction_directions > 1) getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    m_islandManager->~btSimulationIslandManager();
    btAlignedFree(m_islandManager);
    islands_ = new (btAlignedAlloc(sizeof(ContactIslands), 16)) ContactIslands;
    m_islandManager = islands_;  // Bullet destroys it
  }

  void solveConstraints(btContactSolverInfo& info) override {
    first_contacts_.look(manifolds_of(*getDispatcher()), *getPairCache());
    const auto joints = std::span(m_constraints.size() > 0 ? &m_constraints[0] : nullptr,
                                  static_cast<std::size_t>(m_constraints.size()));
    m_constraintSolver->prepareSolve(getNumCollisionObjects(), getDispatcher()->getNumManifolds());
    islands_->solve(*this, joints, *m_constraintSolver, info);
    m_constraintSolver->allSolved(info, nullptr);
  }

  /// Switched off: Bullet's predictive contacts are in no pair's cache, so hand-offs could not carry them. Continuous
  /// collision detection still stops fast bodies.
  void createPredictiveContacts(btScalar) override {}

  /// Bullet moves all bodies. Those whose spin changes freely then get the rotation of free_rotation.h.
  void integrateTransforms(btScalar dt) override {
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

 private:
  /// Sorts bodies by rank before they are moved. A fast body stops at others where they are at that moment, moved
  /// already or not. That may not depend on the order in which bodies arrived.
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

  ContactIslands* islands_ = nullptr;
  FirstContacts& first_contacts_;
  const bool sweeps_;
  std::vector<Tumbling> tumbling_;
};

}  // namespace

void World::couple(const Coupling&) {
  throw std::invalid_argument("only the soft step can be coupled with other regions");
}

std::unique_ptr<World> make_stepper(const WorldParts& parts, const Settings& settings) {
  return std::make_unique<Stepper>(parts, settings);
}

}  // namespace aurasim::physics
