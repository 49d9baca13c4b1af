// The part of soft/kernel.h that solves joints.
#pragma once

#include "physics/soft/kernel_drives.h"

namespace aurasim::physics::soft {
namespace {

/// Share of an axis's error that is undone in a substep.
constexpr Real kErrorReduction = Real(0.2);

constexpr unsigned kSprings = kSpringAxis * 0b111111, kShifts = (kHeldAxis | kSpringAxis) * 0b111;
constexpr unsigned kTurns = ((kHeldAxis | kSpringAxis) * 0b111000) | kJointMotor;

/// atan2(y, x) by the polynomial of Cephes' atanf for arguments below tan(pi/8); other arguments are reduced to these.
AURASIM_INLINE Lanes arc_tangent(const Lanes& y, const Lanes& x) {
  const Lanes along = abs(x), across = abs(y);
  const Lanes large = max(max(along, across), all(Real(1e-30))), small = min(along, across);
  const auto wide = small > all(Real(0.41421356)) * large;
  const Lanes t = (wide ? small - large : small) / (wide ? small + large : large);
  const Lanes z = t * t;
  const Lanes series = (((all(Real(8.05374449538e-2)) * z - Real(1.38776856032e-1)) * z + Real(1.99777106478e-1)) * z -
                        Real(3.33329491539e-1)) *
                           z * t +
                       t;
  Lanes angle = wide ? series + Real(0.785398163397448) : series;
  angle = across > along ? Real(1.5707963267948966) - angle : angle;
  angle = x < Lanes{} ? Real(3.141592653589793) - angle : angle;
  return y < Lanes{} ? -angle : angle;
}

/// Rotates a symmetric matrix by the turn `t`.
AURASIM_INLINE void turn_inertia(const Lanes (&m)[6], const Turned& t, Lanes (&to)[6]) {
  const Lanes zero{};
  // rows of the turn's rotation matrix
  Vec rows[3] = {{all(1), zero, zero}, {zero, all(1), zero}, {zero, zero, all(1)}};
  const Turned back{t.dp, mul(all(-1), t.q), t.q_w};
  for (Vec& row : rows) row = add(row, turn_of(back, row));
  const Vec x = mul(m, rows[0]), y = mul(m, rows[1]), z = mul(m, rows[2]);
  to[0] = dot(rows[0], x), to[1] = dot(rows[0], y), to[2] = dot(rows[0], z);
  to[3] = dot(rows[1], y), to[4] = dot(rows[1], z), to[5] = dot(rows[2], z);
}

/// Sets wanted speed and impulse bounds of an axis. A held axis is pulled back; of two limits the nearer one acts, like
/// a contact.
AURASIM_INLINE void aim(JointBlock::Axis& axis, const Lanes& most, Real h_s) {
  const Lanes zero{}, per_s = all(1 / h_s);
  const auto held = axis.low == axis.high;
  const Lanes above = axis.x - axis.low, below = axis.high - axis.x;
  const auto at_low = above < below;
  const Lanes room = at_low ? above : below;
  const Lanes closing = (room > zero ? per_s : kErrorReduction * per_s) * room;
  axis.wanted = held ? -kErrorReduction * per_s * above : (at_low ? -closing : closing);
  axis.least = held | ~at_low ? -most : zero;
  axis.most = held | at_low ? most : zero;
}

/// The three angles, rad, and the axis about which an impulse on each angle acts.
struct Angles {
  Lanes x[3];
  Vec n[3];
};
AURASIM_INLINE Angles angles(const Vec (&a)[3], const Vec (&b)[3]) {
  const Lanes r_00 = dot(b[0], a[0]), r_01 = dot(b[0], a[1]), r_02 = dot(b[0], a[2]);
  const Lanes r_12 = dot(b[1], a[2]), r_22 = dot(b[2], a[2]);
  const Lanes cosine = root(r_00 * r_00 + r_01 * r_01);
  const Vec node = cross(a[2], b[0]);
  const Lanes per_length = all(1) / max(root(dot(node, node)), all(Real(1e-6)));
  const Vec middle = mul(per_length, node);
  const Lanes per_cosine = all(1) / max(cosine, all(Real(0.1)));
  return {{arc_tangent(-r_12, r_22), arc_tangent(r_02, cosine), arc_tangent(-r_01, r_00)},
          {mul(per_cosine, cross(middle, a[2])), middle, mul(per_cosine, cross(b[0], middle))}};
}

AURASIM_INLINE void look_at_axis(JointBlock& block, int axis, const Vec& n, const Lanes& x, Real h_s) {
  auto& of = block.axes[axis];
  set(of.n, n);
  of.x = x;
  of.mass = block.whole * (axis < 3 ? mass_along(block, n) : mass_about(block, n));
  aim(of, block.whole * min(block.breaks, all(Real(1e30))), h_s);
}

/// The effective mass of the three translations together: the inverse of the matrix that turns impulses along their
/// axes into speeds along them, by elimination. Bodies with arms that are far longer than they are large leave nothing
/// but rounding of the last rows, so a row keeps a small share of its own: then the joint is softer.
AURASIM_INLINE void look_at_shifts(JointBlock& block) {
  const Lanes inv_mass = block.inv_mass_a + block.inv_mass_b;
  Vec on_a[3], on_b[3], turned_a[3], turned_b[3];
  for (int i = 0; i < 3; ++i) {
    const Vec n = load(block.axes[i].n);
    on_a[i] = cross(load(block.arm_a), n), on_b[i] = cross(load(block.arm_b), n);
    turned_a[i] = mul(block.inv_inertia_a, on_a[i]), turned_b[i] = mul(block.inv_inertia_b, on_b[i]);
  }
  const auto at = [&](int i, int k) { return dot(on_a[i], turned_a[k]) + dot(on_b[i], turned_b[k]); };
  const Lanes xx = inv_mass + at(0, 0), yy = inv_mass + at(1, 1), zz = inv_mass + at(2, 2);
  const Lanes xy = at(0, 1), xz = at(0, 2), yz = at(1, 2), least = all(Real(1e-6));
  const Lanes per_x = inverse(xx);
  const Lanes y_x = xy * per_x, z_x = xz * per_x;
  const Lanes rest_y = max(yy - y_x * xy, least * yy), per_y = inverse(rest_y);
  const Lanes z_y = (yz - z_x * xy) * per_y;
  const Lanes per_z = inverse(max(zz - z_x * xz - z_y * z_y * rest_y, least * zz));
  const Lanes both = y_x * z_y - z_x;
  const Lanes whole = block.whole;
  block.shift_mass[0] = whole * (per_x + y_x * y_x * per_y + both * both * per_z);
  block.shift_mass[1] = whole * (-y_x * per_y - both * z_y * per_z), block.shift_mass[2] = whole * both * per_z;
  block.shift_mass[3] = whole * (per_y + z_y * z_y * per_z), block.shift_mass[4] = whole * -z_y * per_z;
  block.shift_mass[5] = whole * per_z;
}

AURASIM_INLINE Lanes took_most(const JointBlock& block, unsigned what) {
  Lanes most = block.took;
  for (int i = 0; i < 6; ++i) {
    if ((what & kHeldAxis << i) != 0) most = max(most, abs(block.axes[i].impulse));
  }
  if ((what & kOwnRows) != 0) most = max(most, own_took_most(block, what));
  return (what & kJointMotor) != 0 ? max(most, abs(block.motor_took)) : most;
}

void look_at_joints(JointBlock* blocks, std::size_t count, unsigned what, const Mover* movers, Real h_s) {
  for (std::size_t k = 0; k < count; ++k) {
    JointBlock& block = blocks[k];
    const Turned moved_a = moved(block.a, movers), moved_b = moved(block.b, movers);
    const Vec r_a = load(block.r_a), r_b = load(block.r_b);
    const Vec turn_a = turn_of(moved_a, r_a), turn_b = turn_of(moved_b, r_b);
    const Vec apart = add(load(block.apart), sub(add(moved_a.dp, turn_a), add(moved_b.dp, turn_b)));
    set(block.arm_a, add(r_a, turn_a));
    set(block.arm_b, add(add(r_b, turn_b), apart));
    turn_inertia(block.start_inertia_a, moved_a, block.inv_inertia_a);
    turn_inertia(block.start_inertia_b, moved_b, block.inv_inertia_b);
    Vec frame_a[3], frame_b[3];
    for (int i = 0; i < 3; ++i) {
      const Vec a = load(block.frame_a[i]), b = load(block.frame_b[i]);
      frame_a[i] = add(a, turn_of(moved_a, a));
      frame_b[i] = add(b, turn_of(moved_b, b));
    }
    if ((what & kTurns) != 0) {
      const Angles turned = angles(frame_a, frame_b);
      const Lanes before = block.axes[5].x;
      for (int i = 0; i < 3; ++i) look_at_axis(block, 3 + i, turned.n[i], turned.x[i], h_s);
      if ((what & kWholeTurns) != 0) {
        look_at_axis(block, 5, turned.n[2], nearest_turn(turned.x[2], before), h_s);
      }
    }
    for (int i = 0; i < 3 && (what & kShifts) != 0; ++i) {
      look_at_axis(block, i, frame_b[i], dot(apart, frame_b[i]), h_s);
    }
    if ((what & kHeldShifts) != 0) look_at_shifts(block);
    if ((what & kOwnRows) != 0) look_at_own(block, what);
  }
}

/// Applies a spring with damper. Stiffness and damping are limited to what is stable in the substep. Returns the
/// impulse.
AURASIM_INLINE Lanes spring(Pair& p, const JointBlock& block, int axis, Real h_s) {
  const auto& spring = block.axes[axis];
  const Vec n = load(spring.n);
  const Lanes stiffness = min(spring.stiffness, spring.mass / (16 * h_s * h_s));
  const Lanes damping = min(spring.damping, spring.mass / h_s);
  const Lanes impulse = -h_s * (stiffness * (spring.x - spring.rest) + damping * rate(p, block, axis, n));
  push_axis(p, block, axis, n, impulse);
  return impulse;
}

void begin_joints(JointBlock* blocks, std::size_t count, unsigned what, Mover* movers, Real h_s) {
  for (std::size_t k = 0; k < count; ++k) {
    JointBlock& block = blocks[k];
    block.took = took_most(block, what);
    block.whole = block.took < block.breaks ? all(1) : Lanes{};
    block.motor_took = Lanes{};
    for (auto& axis : block.axes) {
      axis.impulse = Lanes{};
      axis.mass = block.whole * axis.mass, axis.least = block.whole * axis.least, axis.most = block.whole * axis.most;
    }
    for (Lanes& mass : block.shift_mass) mass = block.whole * mass;
    if ((what & kOwnRows) != 0) begin_own(block, what);
    if ((what & (kSprings | kDampedBall)) == 0) continue;
    Pair p = velocities(block, movers);
    if ((what & kDampedBall) != 0) block.took = max(block.took, damp_ball(p, block));
    for (int i = 0; i < 6; ++i) {
      if ((what & kSpringAxis << i) != 0) block.took = max(block.took, abs(spring(p, block, i, h_s)));
    }
    store(p, block, movers);
  }
}

AURASIM_INLINE void solve_axis(Pair& p, JointBlock& block, int axis) {
  auto& of = block.axes[axis];
  const Vec n = load(of.n);
  const Lanes wanted = of.impulse + of.mass * (of.wanted - rate(p, block, axis, n));
  const Lanes total = max(of.least, min(of.most, wanted));
  push_axis(p, block, axis, n, total - of.impulse);
  of.impulse = total;
}

/// Solves the three held translations together.
AURASIM_INLINE void solve_shifts(Pair& p, JointBlock& block) {
  const Vec n[3] = {load(block.axes[0].n), load(block.axes[1].n), load(block.axes[2].n)};
  const Vec v = speed(p, load(block.arm_a), load(block.arm_b));
  const Vec missing = {block.axes[0].wanted + dot(v, n[0]), block.axes[1].wanted + dot(v, n[1]),
                       block.axes[2].wanted + dot(v, n[2])};
  const Vec gain = mul(block.shift_mass, missing);
  const Lanes gains[3] = {gain.x, gain.y, gain.z};
  Vec impulse{};
  for (int i = 0; i < 3; ++i) {
    auto& of = block.axes[i];
    const Lanes total = max(of.least, min(of.most, of.impulse + gains[i]));
    impulse = add(impulse, mul(of.impulse - total, n[i]));
    of.impulse = total;
  }
  push(p, block, impulse, load(block.arm_a), load(block.arm_b));
}

AURASIM_INLINE void solve_motor(Pair& p, JointBlock& block) {
  const Vec n = load(block.axes[5].n);
  const Lanes wanted = block.motor_took + block.axes[5].mass * (block.motor_rad_s - rate(p, block, 5, n));
  const Lanes total = max(-block.motor_impulse, min(block.motor_impulse, wanted));
  push_axis(p, block, 5, n, total - block.motor_took);
  block.motor_took = total;
}

/// Solves translations last, because their errors are the most visible.
void solve_joints(JointBlock* blocks, std::size_t count, unsigned what, Mover* movers) {
  for (std::size_t k = 0; k < count; ++k) {
    JointBlock& block = blocks[k];
    Pair p = velocities(block, movers);
    if ((what & kJointMotor) != 0) solve_motor(p, block);
    if ((what & kOwnRows) != 0) solve_own(p, block, what);
    const bool together = (what & kHeldShifts) != 0;
    for (int i = 5; i >= (together ? 3 : 0); --i) {
      if ((what & kHeldAxis << i) != 0) solve_axis(p, block, i);
    }
    if (together) solve_shifts(p, block);
    store(p, block, movers);
  }
}

}  // namespace
}  // namespace aurasim::physics::soft
