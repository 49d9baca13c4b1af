#include "physics/driven_constraint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"

namespace aurasim::physics {
namespace {

/// Share of the overshoot beyond a joint's limit that is undone in a substep.
constexpr double kErrorReduction = 0.2;
/// Least `give` of a constant effort, which otherwise would not yield at all: the share by which it falls at 1 rad/s or
/// 1 m/s.
constexpr double kLeastGive = 1e-9;

bool has_spring(const JointAxes& joint) { return joint.resistance.stiffness > 0 || joint.resistance.damping > 0; }

/// The limits of a hinge that Bullet cannot enforce; null if there are none.
const JointAxes::Axis* wide_turn(const JointAxes& joint) {
  if (joint.own != 5u) return nullptr;
  const JointAxes::Axis& turn = joint.axes[5];
  return turn.is_held && !is_within_half_a_turn({turn.low, turn.high}) ? &turn : nullptr;
}

class Rows {
 public:
  Rows(btTypedConstraint::btConstraintInfo2& info, int first) : info_(info), row_(first) {}

  /// Makes the next row act about this axis, on a relative to b.
  void turn(const btVector3& axis) { set(info_.m_J1angularAxis, axis), set(info_.m_J2angularAxis, -axis); }
  /// Makes the next row act along this axis, by impulses at arms `r_a`, `r_b` from the centres of mass.
  void slide(const btVector3& axis, const btVector3& r_a, const btVector3& r_b) {
    set(info_.m_J1linearAxis, axis), set(info_.m_J2linearAxis, -axis);
    set(info_.m_J1angularAxis, r_a.cross(axis)), set(info_.m_J2angularAxis, axis.cross(r_b));
  }

  void push(double wanted, double least, double most) {
    at(info_.m_constraintError) = scalar(wanted);
    at(info_.m_lowerLimit) = scalar(std::max(least, -double{SIMD_INFINITY}));
    at(info_.m_upperLimit) = scalar(std::min(most, double{SIMD_INFINITY}));
    ++row_;
  }
  void pull(const ImplicitPull& by, double position) {
    const double pull = by.stiffness * (by.position - position) + by.steady;
    const double give = std::max(by.give, kLeastGive * std::abs(pull));
    if (!(give > 0)) return push(0, 0, 0);
    at(info_.cfm) = scalar(-give);
    push(pull / give, -by.most, by.most);
  }

 private:
  btScalar& at(btScalar* column) { return column[row_ * info_.rowskip]; }
  void set(btScalar* column, const btVector3& v) {
    for (int i = 0; i < 3; ++i) (&at(column))[i] = v[i];
  }

  btTypedConstraint::btConstraintInfo2& info_;
  int row_;
};

/// Adds a row that keeps the joint within the nearer limit, one-sided as a contact.
void push_off_limits(const JointAxes::Axis& limits, double position, double substep_s, Rows& rows) {
  const double above = position - limits.low, below = limits.high - position;
  const bool at_low = above < below;
  const double room = at_low ? above : below;
  const double closing = (room > 0 ? 1 : kErrorReduction) * room / substep_s;
  rows.push(at_low ? -closing : closing, at_low ? 0 : -SIMD_INFINITY, at_low ? SIMD_INFINITY : 0);
}

void damp_ball(double damping, double substep_s, Rows& rows) {
  const double give = substep_s * damping;
  for (int i = 0; i < 3; ++i) {
    btVector3 axis(0, 0, 0);
    axis[i] = 1;
    rows.turn(axis);
    rows.pull({.give = give, .most = SIMD_INFINITY}, 0);
  }
}

}  // namespace

bool is_within_half_a_turn(const core::JointLimits& limits) {
  return limits.low >= -std::numbers::pi && limits.high <= std::numbers::pi;
}

int own_rows(const JointAxes& joint) {
  if (joint.ball_damping > 0) return 3;
  if (!joint.own) return 0;
  return int{wide_turn(joint) != nullptr} + int{has_spring(joint)} + int{joint.resistance.friction > 0} +
         int{joint.is_driven()};
}

void write_own_rows(const JointAxes& joint, double substep_s, const btRigidBody& a, const btRigidBody& b, int first,
                    btTypedConstraint::btConstraintInfo2& info) {
  Rows rows(info, first);
  if (joint.ball_damping > 0) return damp_ball(joint.ball_damping, substep_s, rows);
  if (own_rows(joint) == 0) return;
  const btTransform X_WJ = a.getWorldTransform() * to_bullet(joint.frames.X_AJ);
  const auto aim = [&] {
    if (joint.own == 5u) return rows.turn(X_WJ.getBasis().getColumn(2));
    const btMatrix3x3 R_WJ = b.getWorldTransform().getBasis() * to_bullet(joint.frames.X_BJ).getBasis();
    rows.slide(R_WJ.getColumn(2), X_WJ.getOrigin() - a.getWorldTransform().getOrigin(),
               X_WJ.getOrigin() - b.getWorldTransform().getOrigin());
  };
  if (const JointAxes::Axis* limits = wide_turn(joint)) {
    aim(), push_off_limits(*limits, joint.position, substep_s, rows);
  }
  if (has_spring(joint)) aim(), rows.pull(pull_of(joint.resistance, substep_s), joint.position);
  if (const double most = substep_s * joint.resistance.friction; most > 0) aim(), rows.push(0, -most, most);
  if (joint.is_driven()) aim(), rows.pull(drive_pull_of(joint, substep_s), joint.position);
}

void let_give(btSolverConstraint& row) {
  if (!(row.m_cfm < 0)) return;
  const btScalar give = -row.m_cfm, mass = row.m_jacDiagABInv;
  const btScalar share = give / (mass + give);
  row.m_rhs *= share;
  row.m_jacDiagABInv *= share;
  row.m_cfm = mass / (mass + give);
}

}  // namespace aurasim::physics
