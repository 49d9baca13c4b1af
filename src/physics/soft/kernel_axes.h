// Impulses along and about the axes of joints. Included by the other joint parts of soft/kernel.h.
#pragma once

#include "physics/soft/kernel_vectors.h"

namespace aurasim::physics::soft {
namespace {

AURASIM_INLINE Lanes abs(const Lanes& a) { return a < Lanes{} ? -a : a; }
AURASIM_INLINE Lanes inverse(const Lanes& a) { return a > Lanes{} ? all(1) / a : Lanes{}; }
AURASIM_INLINE void set(Lanes (&to)[3], const Vec& v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; }

AURASIM_INLINE Lanes mass_along(const JointBlock& block, const Vec& n) {
  const Vec a = cross(load(block.arm_a), n), b = cross(load(block.arm_b), n);
  return inverse(block.inv_mass_a + block.inv_mass_b + dot(a, mul(block.inv_inertia_a, a)) +
                 dot(b, mul(block.inv_inertia_b, b)));
}

AURASIM_INLINE Lanes mass_about(const JointBlock& block, const Vec& n) {
  return inverse(dot(n, add(mul(block.inv_inertia_a, n), mul(block.inv_inertia_b, n))));
}

/// Applies an impulse to a, and its opposite to b.
AURASIM_INLINE void push_axis(Pair& p, const JointBlock& block, int axis, const Vec& n, const Lanes& impulse) {
  if (axis < 3) {
    push(p, block, mul(-impulse, n), load(block.arm_a), load(block.arm_b));
  } else {
    turn(p, block, mul(-impulse, n));
  }
}

/// Speed of a relative to b along or about the axis.
AURASIM_INLINE Lanes rate(const Pair& p, const JointBlock& block, int axis, const Vec& n) {
  if (axis < 3) return -dot(speed(p, load(block.arm_a), load(block.arm_b)), n);
  return dot(sub(p.w_a, p.w_b), n);
}

}  // namespace
}  // namespace aurasim::physics::soft
