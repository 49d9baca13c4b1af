// Adds drives and resistances (core/joint.h) to Bullet's joints, as rows of their own.
#pragma once

#include <utility>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>

#include "physics/joint_axes.h"

namespace aurasim::physics {

/// Can Bullet enforce these limits of a hinge itself? It knows the angle only within half a turn.
bool is_within_half_a_turn(const core::JointLimits& limits);

/// Number of rows that a joint has beyond Bullet's.
int own_rows(const JointAxes& joint);
/// Writes the own rows of a joint from row `first` on, that of the drive last.
void write_own_rows(const JointAxes& joint, double substep_s, const btRigidBody& a, const btRigidBody& b, int first,
                    btTypedConstraint::btConstraintInfo2& info);

/// Prepares a row that yields by `give` (ImplicitPull), which Bullet does not support. getInfo2() marks such a row with
/// cfm = -give. This converts it to one that Bullet's solver solves correctly.
void let_give(btSolverConstraint& row);

template <class Joint>
class Driven final : public Joint {
 public:
  template <class... Arguments>
  explicit Driven(double substep_s, Arguments&&... arguments)
      : Joint(std::forward<Arguments>(arguments)...), substep_s_(substep_s) {}

  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    if constexpr (std::is_same_v<Joint, btHingeConstraint>) {
      this->enableMotor(axes().has_motor && !axes().drive);  // while a drive is set, it replaces the motor
    }
    Joint::getInfo1(info);
    rows_of_bullet_ = info->m_numConstraintRows;
    info->m_numConstraintRows += own_rows(axes());
  }
  void getInfo2(btTypedConstraint::btConstraintInfo2* info) override {
    Joint::getInfo2(info);
    write_own_rows(axes(), substep_s_, this->m_rbA, this->m_rbB, rows_of_bullet_, *info);
  }

 private:
  const JointAxes& axes() { return *static_cast<const JointAxes*>(this->getUserConstraintPtr()); }

  double substep_s_;
  int rows_of_bullet_ = 0;
};

}  // namespace aurasim::physics
