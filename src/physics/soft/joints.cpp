#include "physics/soft/joints.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/progress.h"
#include "physics/bullet_convert.h"
#include "physics/joint_axes.h"
#include "physics/prefetch.h"
#include "physics/soft/convert.h"

namespace aurasim::physics {
namespace {

using soft::Lanes;
using soft::Real;

JointAxes& axes_of(btTypedConstraint& joint) { return *static_cast<JointAxes*>(joint.getUserConstraintPtr()); }

unsigned what_of(const JointAxes& joint) {
  unsigned what = joint.has_motor && !joint.drive ? soft::kJointMotor : 0;
  if (joint.is_driven()) what |= soft::kJointDrive;
  if (joint.resistance.stiffness > 0 || joint.resistance.damping > 0) what |= soft::kJointSpring;
  if (joint.resistance.friction > 0) what |= soft::kJointFriction;
  if (joint.own == 2u) what |= soft::kSlides;
  if (joint.counts_turns()) what |= soft::kWholeTurns;
  if (joint.ball_damping > 0) what |= soft::kDampedBall;
  const auto is_fixed = [](const JointAxes::Axis& axis) { return axis.is_held && axis.low == axis.high; };
  if (std::ranges::all_of(std::span(joint.axes).first<3>(), is_fixed)) what |= soft::kHeldShifts;
  for (std::size_t i = 0; i < joint.axes.size(); ++i) {
    if (joint.axes[i].is_held) what |= soft::kHeldAxis << i;
    if (joint.axes[i].stiffness > 0 || joint.axes[i].damping > 0) what |= soft::kSpringAxis << i;
  }
  return what;
}

void set(Lanes (&to)[3], int lane, const btVector3& v) {
  for (int i = 0; i < 3; ++i) to[i][lane] = static_cast<Real>(v[i]);
}

/// Writes a pull into one lane. Angles in blocks leave out the whole turns that a joint has made by the start of the
/// step.
void set(soft::JointBlock::Pull& to, int lane, const ImplicitPull& from, double turns_rad) {
  to.position[lane] = static_cast<Real>(from.position - turns_rad);
  to.drift[lane] = static_cast<Real>(from.drift);
  to.stiffness[lane] = static_cast<Real>(from.stiffness);
  to.steady[lane] = static_cast<Real>(from.steady);
  to.give[lane] = static_cast<Real>(from.give);
  to.most[lane] = static_cast<Real>(from.most);
}

void set_own(soft::JointBlock& block, int lane, const JointAxes& axes, double substep_s) {
  if (axes.drive) set(block.drive, lane, drive_pull_of(axes, substep_s), axes.turns_rad);
  set(block.spring, lane, pull_of(axes.resistance, substep_s), axes.turns_rad);
  block.friction[lane] = static_cast<Real>(substep_s * axes.resistance.friction);
  if (!axes.counts_turns()) return;
  soft::JointBlock::Axis& turn = block.axes[5];
  turn.x[lane] = static_cast<Real>(axes.position - axes.turns_rad);
  turn.low[lane] = static_cast<Real>(axes.axes[5].low - axes.turns_rad);
  turn.high[lane] = static_cast<Real>(axes.axes[5].high - axes.turns_rad);
}

}  // namespace

SoftJoints::SoftJoints(double substep_s) : substep_s_(substep_s), h_s_(static_cast<Real>(substep_s)) {}

void SoftJoints::put(std::size_t i, btTypedConstraint& joint, std::int32_t first, std::int32_t second) {
  JointAxes& axes = axes_of(joint);
  joints_[i] = {&joint, &axes, first, second, what_of(axes)};
  if (axes.b_is_first) std::swap(joints_[i].a, joints_[i].b);
}

void SoftJoints::prefetch_parts(btTypedConstraint& joint) {
  prefetch(joint.getUserConstraintPtr(), sizeof(JointAxes));
  prefetch_flags(joint.getRigidBodyA()), prefetch_flags(joint.getRigidBodyB());
}

void SoftJoints::build(std::size_t movers, std::span<const SoftInertia> inertias, soft::Team& team) {
  kinds_.clear();
  for (const Joint& joint : joints_) {
    const auto place = std::ranges::lower_bound(kinds_, joint.what);
    if (place == kinds_.end() || *place != joint.what) kinds_.insert(place, joint.what);
  }
  layout_.clear(movers, kinds_.size(), joints_.size());
  find_groups(movers);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = joints_[i];
    const auto group =
        static_cast<std::size_t>(groups_[static_cast<std::size_t>(first_of(std::max(joint.a, joint.b)))]);
    const auto kind = std::ranges::lower_bound(kinds_, joint.what) - kinds_.begin();
    layout_.put(i, joint.a, joint.b, static_cast<std::size_t>(kind), SoftPhase::kInside, group % kSoftGroups);
  }
  blocks_.resize(layout_.place(team));
  team.side_by_side([&](const soft::Worker& worker) {
    const auto [first_block, last_block] = worker.share(blocks_.size());
    for (std::size_t i = first_block; i < last_block; ++i) blocks_[i] = soft::JointBlock{};
    worker.wait();
    const auto [first, last] = worker.share(joints_.size());
    for (std::size_t i = first; i < last; ++i) {
      if (i + kPrefetchDistance / 2 < last) {
        const Joint& soon = joints_[i + kPrefetchDistance / 2];
        prefetch(soon.axes, sizeof(JointAxes));
        for (const btRigidBody* body : {&soon.joint->getRigidBodyA(), &soon.joint->getRigidBodyB()}) {
          prefetch(&body->getWorldTransform(), sizeof(btTransform));
        }
      }
      fill(i, inertias);
    }
  });
}

/// Numbers the mechanisms: bodies that joints bind together.
void SoftJoints::find_groups(std::size_t movers) {
  parents_.resize(movers);
  std::iota(parents_.begin(), parents_.end(), 0);
  for (const Joint& joint : joints_) {
    if (joint.a <= 0 || joint.b <= 0) continue;
    const std::int32_t one = first_of(joint.a), other = first_of(joint.b);
    parents_[static_cast<std::size_t>(std::max(one, other))] = std::min(one, other);
  }
  groups_.assign(movers, -1);
  std::int32_t count = 0;
  for (const Joint& joint : joints_) {
    std::int32_t& group = groups_[static_cast<std::size_t>(first_of(std::max(joint.a, joint.b)))];
    if (group < 0) group = count++;
  }
}

/// First mover of the mechanism. Halves the path to it.
std::int32_t SoftJoints::first_of(std::int32_t mover) {
  auto at = static_cast<std::size_t>(mover);
  while (parents_[at] != static_cast<std::int32_t>(at)) {
    parents_[at] = parents_[static_cast<std::size_t>(parents_[at])];
    at = static_cast<std::size_t>(parents_[at]);
  }
  return static_cast<std::int32_t>(at);
}

void SoftJoints::fill(std::size_t at, std::span<const SoftInertia> inertias) {
  const Joint& joint = joints_[at];
  const JointAxes& axes = *joint.axes;
  soft::JointBlock& block = blocks_[layout_.block(at)];
  const int lane = layout_.lane(at);
  block.a[lane] = joint.a, block.b[lane] = joint.b;
  block.inv_mass_a[lane] = inertias[joint.a].inv_mass, block.inv_mass_b[lane] = inertias[joint.b].inv_mass;
  soft::set(block.start_inertia_a, lane, inertias[joint.a].inv_inertia);
  soft::set(block.start_inertia_b, lane, inertias[joint.b].inv_inertia);
  const btRigidBody &first = joint.joint->getRigidBodyA(), &second = joint.joint->getRigidBodyB();
  const btTransform& X_WA = (axes.b_is_first ? second : first).getWorldTransform();
  const btTransform& X_WB = (axes.b_is_first ? first : second).getWorldTransform();
  const btTransform X_WJ_a = X_WA * to_bullet(axes.frames.X_AJ), X_WJ_b = X_WB * to_bullet(axes.frames.X_BJ);
  set(block.r_a, lane, X_WJ_a.getOrigin() - X_WA.getOrigin());
  set(block.r_b, lane, X_WJ_b.getOrigin() - X_WB.getOrigin());
  set(block.apart, lane, X_WJ_a.getOrigin() - X_WJ_b.getOrigin());
  for (int i = 0; i < 3; ++i) {
    set(block.frame_a[i], lane, X_WJ_a.getBasis().getColumn(i));
    set(block.frame_b[i], lane, X_WJ_b.getBasis().getColumn(i));
  }
  for (std::size_t i = 0; i < axes.axes.size(); ++i) {
    const JointAxes::Axis& from = axes.axes[i];
    soft::JointBlock::Axis& to = block.axes[i];
    to.low[lane] = static_cast<Real>(from.low), to.high[lane] = static_cast<Real>(from.high);
    to.stiffness[lane] = static_cast<Real>(from.stiffness), to.damping[lane] = static_cast<Real>(from.damping);
    to.rest[lane] = static_cast<Real>(from.rest);
  }
  if (axes.own) set_own(block, lane, axes, substep_s_);
  block.ball_give[lane] = static_cast<Real>(substep_s_ * axes.ball_damping);
  block.motor_rad_s[lane] = static_cast<Real>(axes.motor_rad_s);
  block.motor_impulse[lane] = static_cast<Real>(axes.motor_impulse);
  block.whole[lane] = 1;
  block.breaks[lane] = static_cast<Real>(axes.break_impulse);
}

void SoftJoints::look(const soft::Mover* movers, const soft::Worker& worker) {
  layout_.sweep(worker, 1, [&](int, std::size_t first, std::size_t count, std::size_t kind) {
    soft::kernel().look_at_joints(&blocks_[first], count, kinds_[kind], movers, h_s_);
  });
}

void SoftJoints::begin_and_solve(soft::Mover* movers, int sweeps, const soft::Worker& worker) {
  if (worker.is_first()) core::Progress::mark();
  layout_.sweep(worker, 1 + sweeps, [&](int time, std::size_t first, std::size_t count, std::size_t kind) {
    if (time == 0) soft::kernel().begin_joints(&blocks_[first], count, kinds_[kind], movers, h_s_);
    if (time > 0) soft::kernel().solve_joints(&blocks_[first], count, kinds_[kind], movers);
  });
}

void SoftJoints::look_and_solve(soft::Mover* movers, int sweeps, const soft::Worker& worker) {
  if (worker.is_first()) core::Progress::mark();
  layout_.sweep(worker, 1 + sweeps, [&](int time, std::size_t first, std::size_t count, std::size_t kind) {
    if (time == 0) soft::kernel().look_at_joints(&blocks_[first], count, kinds_[kind], movers, h_s_);
    if (time > 0) soft::kernel().solve_joints(&blocks_[first], count, kinds_[kind], movers);
  });
}

void SoftJoints::finish(soft::Team& team) {
  team.for_each(joints_.size(), [this](std::size_t i) { finish(i); });
}

void SoftJoints::finish(std::size_t i) {
  const soft::JointBlock& block = blocks_[layout_.block(i)];
  const int lane = layout_.lane(i);
  JointAxes& axes = *joints_[i].axes;
  const unsigned what = joints_[i].what;
  axes.drive_impulse = 0;
  if ((what & soft::kJointMotor) != 0) axes.drive_impulse = static_cast<double>(block.motor_took[lane]);
  if ((what & soft::kJointDrive) != 0) axes.drive_impulse = static_cast<double>(block.drive.impulse[lane]);
  Real last = static_cast<Real>(std::abs(axes.drive_impulse));
  if ((what & soft::kJointSpring) != 0) last = std::max(last, std::abs(block.spring.impulse[lane]));
  if ((what & soft::kJointFriction) != 0) last = std::max(last, std::abs(block.rubbed[lane]));
  for (int axis = 0; axis < 6; ++axis) {
    if ((what & soft::kHeldAxis << axis) != 0) last = std::max(last, std::abs(block.axes[axis].impulse[lane]));
  }
  joints_[i].joint->internalSetAppliedImpulse(last);
  if (std::max(last, block.took[lane]) >= block.breaks[lane]) joints_[i].joint->setEnabled(false);
}

}  // namespace aurasim::physics
