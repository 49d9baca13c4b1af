// Drives and resistances of hinges and sliders as rows along their free axis, and damping of ball joints.
#pragma once

#include "physics/soft/kernel_axes.h"

namespace aurasim::physics::soft {
namespace {

constexpr unsigned kOwnRows = kJointDrive | kJointSpring | kJointFriction;

AURASIM_INLINE int own_axis(unsigned what) { return (what & kSlides) != 0 ? 2 : 5; }

/// `angle` plus the number of whole turns that brings it nearest to `before`. Exact if that number is 0.
AURASIM_INLINE Lanes nearest_turn(const Lanes& angle, const Lanes& before) {
  constexpr Real kTurn = Real(6.283185307179586), kRounds = Real(12582912);  // 1.5 * 2^23
  const Lanes turns = (before - angle) * all(1 / kTurn);
  return angle + kTurn * ((turns + kRounds) - kRounds);
}

/// An impulse of 1 along or about an axis, applied to a, and its opposite to b.
struct Effect {
  Vec push, on_a, on_b;
};
AURASIM_INLINE Effect effect_of(const JointBlock& block, int axis) {
  const Vec n = load(block.axes[axis].n);
  const Lanes zero{};
  if (axis >= 3) return {{zero, zero, zero}, n, n};
  return {n, cross(load(block.arm_a), n), cross(load(block.arm_b), n)};
}
AURASIM_INLINE Effect without(const Effect& e, const Lanes& times, const Effect& other) {
  return {sub(e.push, mul(times, other.push)), sub(e.on_a, mul(times, other.on_a)),
          sub(e.on_b, mul(times, other.on_b))};
}

/// Computes the effect of an impulse along the free axis while the speeds of the five held axes stay the same. The
/// share that each held axis bears follows from the matrix of all six axes by elimination, the free one last. A direct
/// solution, because sweeps over the axes converge the more slowly, the farther the centres of mass are from the joint.
AURASIM_INLINE void look_at_own(JointBlock& block, unsigned what) {
  const int own = own_axis(what);
  Effect effects[6];
  Vec turned_a[6], turned_b[6];
  for (int i = 0; i < 6; ++i) {
    effects[i] = effect_of(block, (own + 1 + i) % 6);
    turned_a[i] = mul(block.inv_inertia_a, effects[i].on_a);
    turned_b[i] = mul(block.inv_inertia_b, effects[i].on_b);
  }
  Lanes factor[6][6], rest[6], per_rest[6], alone{};
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) {
      Lanes k = (block.inv_mass_a + block.inv_mass_b) * dot(effects[i].push, effects[j].push) +
                dot(effects[i].on_a, turned_a[j]) + dot(effects[i].on_b, turned_b[j]);
      if (i == 5 && j == 5) alone = k;
      for (int m = 0; m < j; ++m) k = k - factor[i][m] * factor[j][m] * rest[m];
      if (j == i) {
        rest[i] = k, per_rest[i] = inverse(k);
      } else {
        factor[i][j] = k * per_rest[j];
      }
    }
  }
  Effect whole = effects[5];
  Lanes borne[5];
  for (int j = 4; j >= 0; --j) {
    borne[j] = factor[5][j];
    for (int m = j + 1; m < 5; ++m) borne[j] = borne[j] - factor[m][j] * borne[m];
    whole = without(whole, borne[j], effects[j]);
    block.borne[(own + 1 + j) % 6] = borne[j];
  }
  block.borne[own] = Lanes{};
  block.own_mass = block.whole * inverse(max(rest[5], all(Real(1e-6)) * alone));
  set(block.own_push, whole.push), set(block.own_a, whole.on_a), set(block.own_b, whole.on_b);
}

AURASIM_INLINE void push_own(Pair& p, JointBlock& block, const Lanes& impulse) {
  const Vec push = mul(impulse, load(block.own_push));
  p.v_a = add(p.v_a, mul(block.inv_mass_a, push));
  p.v_b = sub(p.v_b, mul(block.inv_mass_b, push));
  p.w_a = add(p.w_a, mul(block.inv_inertia_a, mul(impulse, load(block.own_a))));
  p.w_b = sub(p.w_b, mul(block.inv_inertia_b, mul(impulse, load(block.own_b))));
  for (int i = 0; i < 6; ++i) block.axes[i].impulse = block.axes[i].impulse - impulse * block.borne[i];
}

AURASIM_INLINE Lanes own_took_most(const JointBlock& block, unsigned what) {
  Lanes most{};
  if ((what & kJointDrive) != 0) most = max(most, abs(block.drive.impulse));
  if ((what & kJointSpring) != 0) most = max(most, abs(block.spring.impulse));
  return (what & kJointFriction) != 0 ? max(most, abs(block.rubbed)) : most;
}

/// Starts a pull: the joint's position `x` at the start of the substep counts for all of it.
AURASIM_INLINE void begin_pull(JointBlock::Pull& pull, const Lanes& x) {
  pull.pull = pull.stiffness * (pull.position - x) + pull.steady;
  pull.position = pull.position + pull.drift;
  pull.impulse = Lanes{};
}

AURASIM_INLINE void begin_own(JointBlock& block, unsigned what) {
  const Lanes& x = block.axes[own_axis(what)].x;
  begin_pull(block.drive, x), begin_pull(block.spring, x);
  block.rubbed = Lanes{};
  block.own_mass = block.whole * block.own_mass;
}

AURASIM_INLINE void solve_pull(Pair& p, JointBlock& block, JointBlock::Pull& by, int axis) {
  const Lanes v = rate(p, block, axis, load(block.axes[axis].n));
  const Lanes wanted =
      (block.own_mass * (by.pull - by.give * v) + by.give * by.impulse) * inverse(block.own_mass + by.give);
  const Lanes total = max(-by.most, min(by.most, wanted));
  push_own(p, block, total - by.impulse);
  by.impulse = total;
}

AURASIM_INLINE void solve_friction(Pair& p, JointBlock& block, int axis) {
  const Lanes wanted = block.rubbed - block.own_mass * rate(p, block, axis, load(block.axes[axis].n));
  const Lanes total = max(-block.friction, min(block.friction, wanted));
  push_own(p, block, total - block.rubbed);
  block.rubbed = total;
}

AURASIM_INLINE void solve_own(Pair& p, JointBlock& block, unsigned what) {
  const int axis = own_axis(what);
  if ((what & kJointSpring) != 0) solve_pull(p, block, block.spring, axis);
  if ((what & kJointDrive) != 0) solve_pull(p, block, block.drive, axis);
  if ((what & kJointFriction) != 0) solve_friction(p, block, axis);
}

/// Damps a ball joint once a substep, implicitly about each axis of the world. Returns the largest impulse.
AURASIM_INLINE Lanes damp_ball(Pair& p, const JointBlock& block) {
  const Lanes zero{}, one = all(1);
  const Vec axes[3] = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  Lanes most{};
  for (const Vec& n : axes) {
    const Lanes mass = block.whole * mass_about(block, n);
    const Lanes impulse = -block.ball_give * mass * inverse(mass + block.ball_give) * dot(sub(p.w_a, p.w_b), n);
    push_axis(p, block, 3, n, impulse);
    most = max(most, abs(impulse));
  }
  return most;
}

}  // namespace
}  // namespace aurasim::physics::soft
