#include "physics/solvers.h"

#include <algorithm>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/progress.h"
#include "physics/driven_constraint.h"
#include "physics/friction_anchors.h"
#include "physics/prefetch.h"

namespace aurasim::physics {
namespace {

/// Speed at which the gap of a contact opens, m/s: now, and with the substep's forces applied.
struct Opening {
  btScalar now = 0;
  btScalar with_forces = 0;
};

Opening opening_of(const btSolverConstraint& row, const btSolverBody& a, const btSolverBody& b) {
  const auto of = [](const btSolverBody& body, const btVector3& linear, const btVector3& angular) -> Opening {
    if (body.m_originalBody == nullptr) return {};
    const btScalar now = linear.dot(body.m_linearVelocity) + angular.dot(body.m_angularVelocity);
    return {now, now + linear.dot(body.m_externalForceImpulse) + angular.dot(body.m_externalTorqueImpulse)};
  };
  const Opening of_a = of(a, row.m_contactNormal1, row.m_relpos1CrossNormal);
  const Opening of_b = of(b, row.m_contactNormal2, row.m_relpos2CrossNormal);
  return {of_a.now + of_b.now, of_a.with_forces + of_b.with_forces};
}

/// Changes a row so that its contact bounces without gaining or losing energy. Contacts slower than Bullet's threshold
/// are unchanged, so bodies come to rest as in Bullet.
void let_bounce(btSolverConstraint& row, const btSolverBody& a, const btSolverBody& b,
                const btContactSolverInfo& info) {
  const auto& point = *static_cast<const btManifoldPoint*>(row.m_originalContactPoint);
  if (!(point.m_combinedRestitution > 0)) return;
  const Opening opening = opening_of(row, a, b);
  if (opening.now > -info.m_restitutionVelocityThreshold) return;
  const btScalar gap = point.getDistance() + info.m_linearSlop;
  btScalar wanted = -gap / info.m_timeStep;
  if (gap + opening.with_forces * info.m_timeStep <= 0) {  // they would touch within the substep
    const btScalar push = std::max(btScalar(0), -gap * info.m_erp2 / info.m_timeStep);
    wanted = std::max(-point.m_combinedRestitution * opening.now, push);
  }
  row.m_rhs = (wanted - opening.with_forces) * row.m_jacDiagABInv;
  row.m_rhsPenetration = 0;
}

using BulletSolver = btSequentialImpulseConstraintSolver;

class RefinedSolver final : public BulletSolver {
 protected:
  void convertJoints(btTypedConstraint** joints, int count, const btContactSolverInfo& info) override {
    BulletSolver::convertJoints(joints, count, info);
    for (int i = 0; i < m_tmpSolverNonContactConstraintPool.size(); ++i) {
      let_give(m_tmpSolverNonContactConstraintPool[i]);
    }
  }

  void convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) override {
    // Makes the rows in groups, so that later manifolds can be prefetched.
    constexpr int kAtOnce = kPrefetchDistance / 2;
    for (int i = 0; i < count; i += kAtOnce) {
      for (int j = i + 2 * kAtOnce; j < std::min(i + 3 * kAtOnce, count); ++j) prefetch_head(*manifolds[j]);
      for (int j = i + kAtOnce; j < std::min(i + 2 * kAtOnce, count); ++j) prefetch_points(*manifolds[j]);
      BulletSolver::convertContacts(manifolds + i, std::min(kAtOnce, count - i), info);
      core::Progress::mark();
    }
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); ++i) {
      btSolverConstraint& row = m_tmpSolverContactConstraintPool[i];
      let_bounce(row, m_tmpSolverBodyPool[row.m_solverBodyIdA], m_tmpSolverBodyPool[row.m_solverBodyIdB], info);
    }
    friction_anchors_.pull_back(rows(), info);
  }

  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int body_count,
                                btPersistentManifold** manifolds, int manifold_count, btTypedConstraint** joints,
                                int joint_count, const btContactSolverInfo& info, btIDebugDraw* drawer) override {
    core::Progress::mark();
    return BulletSolver::solveSingleIteration(iteration, bodies, body_count, manifolds, manifold_count, joints,
                                              joint_count, info, drawer);
  }

  /// Runs Bullet's one loop of iterations in several parts. Each part ends early where nothing changes any more, as the
  /// whole loop would, so the bits are the same.
  void solveGroupCacheFriendlySplitImpulseIterations(btCollisionObject** bodies, int body_count,
                                                     btPersistentManifold** manifolds, int manifold_count,
                                                     btTypedConstraint** joints, int joint_count,
                                                     const btContactSolverInfo& info, btIDebugDraw* drawer) override {
    constexpr int kAtOnce = 20;
    btContactSolverInfo part = info;
    for (int done = 0; done < info.m_numIterations; done += kAtOnce) {
      part.m_numIterations = std::min(kAtOnce, info.m_numIterations - done);
      BulletSolver::solveGroupCacheFriendlySplitImpulseIterations(bodies, body_count, manifolds, manifold_count, joints,
                                                                  joint_count, part, drawer);
      core::Progress::mark();
    }
  }

  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int count,
                                         const btContactSolverInfo& info) override {
    friction_anchors_.measure(rows(), info);
    const btScalar residual = BulletSolver::solveGroupCacheFriendlyFinish(bodies, count, info);
    friction_anchors_.remember();
    return residual;
  }

 private:
  ContactRows rows() {
    return {m_tmpSolverContactConstraintPool, m_tmpSolverContactFrictionConstraintPool, m_tmpSolverBodyPool};
  }

  FrictionAnchors friction_anchors_;
};

}  // namespace

std::unique_ptr<btConstraintSolver> make_solver() { return std::make_unique<RefinedSolver>(); }

}  // namespace aurasim::physics
