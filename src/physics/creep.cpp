#include "physics/creep.h"

#include <cmath>

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace aurasim::physics {
namespace {

/// Share of the way that is undone in a substep. From 0.2 to 0.4 piles stand alike.
constexpr btScalar kShare = btScalar(0.3);

/// Two directions across the normal that depend on nothing else: the point's own turn with the sliding velocity.
struct Across {
  explicit Across(const btVector3& normal) { btPlaneSpace1(normal, first, second); }
  btVector3 first;
  btVector3 second;
};

btVector3 way_of(const btManifoldPoint& point) {
  const Across across(point.m_normalWorldOnB);
  return across.first * point.m_appliedImpulseLateral1 + across.second * point.m_appliedImpulseLateral2;
}

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

/// Of the two surfaces along a row, with all impulses, m/s.
btScalar speed_along(const btSolverConstraint& row, btAlignedObjectArray<btSolverBody>& bodies) {
  return speed_of(bodies[row.m_solverBodyIdA], row.m_contactNormal1, row.m_relpos1CrossNormal) +
         speed_of(bodies[row.m_solverBodyIdB], row.m_contactNormal2, row.m_relpos2CrossNormal);
}

}  // namespace

void Creep::pull_back(const ContactRows& rows, const btContactSolverInfo& info) const {
  const btScalar per_s = kShare / info.m_timeStep;
  for (int i = 0; i < rows.contacts.size(); ++i) {
    const btManifoldPoint& point = point_of(rows.contacts[i]);
    const btVector3 way = way_of(point);
    for (int d = 0; d < directions(info); ++d) {
      btSolverConstraint& row = rows.friction[rows.contacts[i].m_frictionIndex + d];
      row.m_rhs -= way.dot(direction(point, d)) * per_s * row.m_jacDiagABInv;
    }
  }
}

void Creep::measure(const ContactRows& rows, const btContactSolverInfo& info) {
  found_.clear();
  for (int i = 0; i < rows.contacts.size(); ++i) {
    btManifoldPoint& point = point_of(rows.contacts[i]);
    const btScalar limit = rows.contacts[i].m_friction * static_cast<btScalar>(rows.contacts[i].m_appliedImpulse);
    Of& of = found_.emplace_back(Of{&point, btVector3(0, 0, 0)});
    if (!(limit > 0)) continue;  // nothing presses: forgotten
    bool sticks = true;
    btVector3 slid(0, 0, 0);
    for (int d = 0; d < directions(info); ++d) {
      const btSolverConstraint& row = rows.friction[rows.contacts[i].m_frictionIndex + d];
      sticks = sticks && std::abs(static_cast<btScalar>(row.m_appliedImpulse)) < limit;
      slid += direction(point, d) * (speed_along(row, rows.bodies) * info.m_timeStep);
    }
    of.way = way_of(point);
    if (sticks) of.way += slid;
  }
}

void Creep::remember() {
  for (const Of& of : found_) {
    const Across across(of.point->m_normalWorldOnB);
    of.point->m_appliedImpulseLateral1 = of.way.dot(across.first);
    of.point->m_appliedImpulseLateral2 = of.way.dot(across.second);
  }
}

}  // namespace aurasim::physics
