#include "physics/friction_anchors.h"

#include <cmath>

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace aurasim::physics {
namespace {

/// Share of the slip that is undone in a substep. Piles stand equally well from 0.2 to 0.4.
constexpr btScalar kShare = btScalar(0.3);

btManifoldPoint& point_of(const btSolverConstraint& contact) {
  return *static_cast<btManifoldPoint*>(contact.m_originalContactPoint);
}

int directions(const btContactSolverInfo& info) {
  return (info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS) != 0 ? 2 : 1;
}

const btVector3& direction(const btManifoldPoint& point, int i) {
  return i == 0 ? point.m_lateralFrictionDir1 : point.m_lateralFrictionDir2;
}

btScalar speed_of(btSolverBody& body, const btVector3& linear, const btVector3& angular) {
  if (body.m_originalBody == nullptr) return 0;
  return linear.dot(body.m_linearVelocity + body.m_externalForceImpulse + body.internalGetDeltaLinearVelocity()) +
         angular.dot(body.m_angularVelocity + body.m_externalTorqueImpulse + body.internalGetDeltaAngularVelocity());
}

/// Relative speed of the two surfaces along a row, with all impulses applied, m/s.
btScalar speed_along(const btSolverConstraint& row, btAlignedObjectArray<btSolverBody>& bodies) {
  return speed_of(bodies[row.m_solverBodyIdA], row.m_contactNormal1, row.m_relpos1CrossNormal) +
         speed_of(bodies[row.m_solverBodyIdB], row.m_contactNormal2, row.m_relpos2CrossNormal);
}

}  // namespace

/// Uses its own two directions, because those of the contact point turn with the sliding velocity.
void FrictionAnchors::pull_back(const ContactRows& rows, const btContactSolverInfo& info) {
  const btScalar per_s = kShare / info.m_timeStep;
  contacts_.resize(static_cast<std::size_t>(rows.contacts.size()));
  for (int i = 0; i < rows.contacts.size(); ++i) {
    Of& of = contacts_[static_cast<std::size_t>(i)];
    of.point = &point_of(rows.contacts[i]);
    btPlaneSpace1(of.point->m_normalWorldOnB, of.first, of.second);
    of.way = of.first * of.point->m_appliedImpulseLateral1 + of.second * of.point->m_appliedImpulseLateral2;
    for (int d = 0; d < directions(info); ++d) {
      btSolverConstraint& row = rows.friction[rows.contacts[i].m_frictionIndex + d];
      row.m_rhs -= of.way.dot(direction(*of.point, d)) * per_s * row.m_jacDiagABInv;
    }
  }
}

void FrictionAnchors::measure(const ContactRows& rows, const btContactSolverInfo& info) {
  for (int i = 0; i < rows.contacts.size(); ++i) {
    Of& of = contacts_[static_cast<std::size_t>(i)];
    const btScalar limit = rows.contacts[i].m_friction * static_cast<btScalar>(rows.contacts[i].m_appliedImpulse);
    if (!(limit > 0)) {  // without pressure the slip is forgotten
      of.way.setZero();
      continue;
    }
    bool sticks = true;
    btVector3 slid(0, 0, 0);
    for (int d = 0; d < directions(info) && sticks; ++d) {
      const btSolverConstraint& row = rows.friction[rows.contacts[i].m_frictionIndex + d];
      sticks = std::abs(static_cast<btScalar>(row.m_appliedImpulse)) < limit;
      slid += direction(*of.point, d) * (speed_along(row, rows.bodies) * info.m_timeStep);
    }
    if (sticks) of.way += slid;
  }
}

void FrictionAnchors::remember() {
  for (const Of& of : contacts_) {
    of.point->m_appliedImpulseLateral1 = of.way.dot(of.first);
    of.point->m_appliedImpulseLateral2 = of.way.dot(of.second);
  }
}

}  // namespace aurasim::physics
