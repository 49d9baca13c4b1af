#include "physics/soft/joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/soft/convert.h"

namespace aurasim::physics {
namespace {

using soft::Mover;
using soft::Real;

/// Share of a joint's error that is undone in a substep, as in Bullet's solvers.
constexpr btScalar kErrorReduction = btScalar(0.2);
constexpr int kMostRows = 24;  ///< of one joint: six axes with two limits, a motor and a spring each

/// A row as a joint fills it in. Most joints have few, so only those that they have are set up.
struct Line {
  void clear() {
    for (btVector3* v : {&linear_a, &angular_a, &linear_b, &angular_b}) v->setZero();
    error = mixing = 0, low = -SIMD_INFINITY, high = SIMD_INFINITY;
  }

  btVector3 linear_a, angular_a, linear_b, angular_b;
  btScalar error, mixing, low, high;
};

void push(Real (&to)[3], const btVector3& v) {
  for (int i = 0; i < 3; ++i) to[i] += static_cast<Real>(v[i]);
}

}  // namespace

void SoftJoints::add(btTypedConstraint& joint, std::uint32_t a, std::uint32_t b) {
  joints_.push_back({&joint, a, b, 0, 0});
  for (const std::uint32_t mover : {a, b}) {
    if (is_known_.size() <= mover) is_known_.resize(mover + 1, 0);
    if (mover != 0 && std::exchange(is_known_[mover], 1) == 0) movers_.push_back(mover);
  }
}

void SoftJoints::begin(Real h_s) {
  rows_.clear();
  for (Joint& joint : joints_) make_rows(joint, h_s);
}

void SoftJoints::make_rows(Joint& joint, Real h_s) {
  joint.first_row = static_cast<std::uint32_t>(rows_.size());
  joint.rows = 0;
  if (!joint.joint->isEnabled()) return;
  btTypedConstraint::btConstraintInfo1 count{};
  joint.joint->getInfo1(&count);
  joint.rows = static_cast<std::uint32_t>(count.m_numConstraintRows);
  if (joint.rows == 0) return;
  std::array<Line, kMostRows> lines;
  for (std::uint32_t i = 0; i < joint.rows; ++i) lines[i].clear();
  btTypedConstraint::btConstraintInfo2 info{};
  info.fps = 1 / btScalar(h_s);
  info.erp = kErrorReduction;
  info.m_J1linearAxis = lines[0].linear_a, info.m_J1angularAxis = lines[0].angular_a;
  info.m_J2linearAxis = lines[0].linear_b, info.m_J2angularAxis = lines[0].angular_b;
  info.rowskip = sizeof(Line) / sizeof(btScalar);
  info.m_constraintError = &lines[0].error, info.cfm = &lines[0].mixing;
  info.m_lowerLimit = &lines[0].low, info.m_upperLimit = &lines[0].high;
  info.m_numIterations = 1, info.m_damping = 1;
  joint.joint->getInfo2(&info);
  const btRigidBody& a = joint.joint->getRigidBodyA();
  const btRigidBody& b = joint.joint->getRigidBodyB();
  const btScalar most = joint.joint->getBreakingImpulseThreshold();
  for (std::uint32_t i = 0; i < joint.rows; ++i) {
    const Line& line = lines[i];
    Row row{line.linear_a, line.angular_a, line.linear_b, line.angular_b, {}, {}, {}, {}, 0, 0, 0, 0, 0, 0};
    row.v_a = line.linear_a * a.getInvMass(), row.w_a = a.getInvInertiaTensorWorld() * line.angular_a;
    row.v_b = line.linear_b * b.getInvMass(), row.w_b = b.getInvInertiaTensorWorld() * line.angular_b;
    const btScalar response =
        row.linear_a.dot(row.v_a) + row.angular_a.dot(row.w_a) + row.linear_b.dot(row.v_b) + row.angular_b.dot(row.w_b);
    row.mass = response > SIMD_EPSILON ? 1 / response : 0;
    row.error = line.error, row.mixing = line.mixing;
    row.low = std::max(line.low, -most), row.high = std::min(line.high, most);
    rows_.push_back(row);
  }
}

void SoftJoints::solve(Mover* movers) {
  for (const Joint& joint : joints_) {
    Mover& a = movers[joint.a];
    Mover& b = movers[joint.b];
    for (std::uint32_t i = joint.first_row; i < joint.first_row + joint.rows; ++i) {
      Row& row = rows_[i];
      const btScalar v = row.linear_a.dot(soft::to_bullet(a.v)) + row.angular_a.dot(soft::to_bullet(a.w)) +
                         row.linear_b.dot(soft::to_bullet(b.v)) + row.angular_b.dot(soft::to_bullet(b.w));
      const btScalar wanted = row.impulse + (row.error - v) * row.mass - row.impulse * row.mixing;
      const btScalar total = std::clamp(wanted, row.low, row.high);
      const btScalar more = total - row.impulse;
      row.impulse = total;
      if (joint.a != 0) push(a.v, row.v_a * more), push(a.w, row.w_a * more);
      if (joint.b != 0) push(b.v, row.v_b * more), push(b.w, row.w_b * more);
    }
  }
}

void SoftJoints::finish() {
  for (const Joint& joint : joints_) {
    for (std::uint32_t i = joint.first_row; i < joint.first_row + joint.rows; ++i) {
      joint.joint->internalSetAppliedImpulse(rows_[i].impulse);
      if (std::abs(rows_[i].impulse) >= joint.joint->getBreakingImpulseThreshold()) joint.joint->setEnabled(false);
    }
  }
}

}  // namespace aurasim::physics
