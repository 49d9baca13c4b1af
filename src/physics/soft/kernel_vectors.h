// Vectors of lanes and pairs of bodies, for what soft/kernel.h includes.
#pragma once

#include "physics/soft/lanes.h"

/// Else a call passes its vectors through memory.
#define AURASIM_INLINE [[gnu::always_inline]] inline

namespace aurasim::physics::soft {
namespace {

struct Vec {
  Lanes x, y, z;
};
/// Of two bodies.
struct Pair {
  Vec v_a, w_a, v_b, w_b;
};

AURASIM_INLINE Vec load(const Lanes (&v)[3]) { return {v[0], v[1], v[2]}; }
AURASIM_INLINE Vec add(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
AURASIM_INLINE Vec sub(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
AURASIM_INLINE Vec mul(const Lanes& s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
AURASIM_INLINE Lanes dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
AURASIM_INLINE Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// A symmetric matrix, as in Block.
AURASIM_INLINE Vec mul(const Lanes (&m)[6], const Vec& a) {
  return {m[0] * a.x + m[1] * a.y + m[2] * a.z, m[1] * a.x + m[3] * a.y + m[4] * a.z,
          m[2] * a.x + m[4] * a.y + m[5] * a.z};
}
AURASIM_INLINE Lanes max(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
AURASIM_INLINE Lanes min(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
AURASIM_INLINE Lanes all(Real x) { return x - Lanes{}; }
AURASIM_INLINE Real root(Real a) { return __builtin_sqrtf(a); }
AURASIM_INLINE Lanes root(Lanes a) {
  for (int i = 0; i < kLanes; ++i) a[i] = root(a[i]);
  return a;
}
/// What scales an impulse of such a length down to `most`.
AURASIM_INLINE Lanes share(const Lanes& length, const Lanes& most) { return length > most ? most / length : all(1); }

template <class AnyBlock>
AURASIM_INLINE Pair velocities(const AnyBlock& block, const Mover* movers) {
  Pair p;
  for (int i = 0; i < kLanes; ++i) {
    const Mover& a = movers[block.a[i]];
    const Mover& b = movers[block.b[i]];
    p.v_a.x[i] = a.v[0], p.v_a.y[i] = a.v[1], p.v_a.z[i] = a.v[2];
    p.w_a.x[i] = a.w[0], p.w_a.y[i] = a.w[1], p.w_a.z[i] = a.w[2];
    p.v_b.x[i] = b.v[0], p.v_b.y[i] = b.v[1], p.v_b.z[i] = b.v[2];
    p.w_b.x[i] = b.w[0], p.w_b.y[i] = b.w[1], p.w_b.z[i] = b.w[2];
  }
  return p;
}
template <class AnyBlock>
AURASIM_INLINE void store(const Pair& p, const AnyBlock& block, Mover* movers) {
  for (int i = 0; i < kLanes; ++i) {
    if (block.a[i] != 0) {
      Mover& a = movers[block.a[i]];
      a.v[0] = p.v_a.x[i], a.v[1] = p.v_a.y[i], a.v[2] = p.v_a.z[i];
      a.w[0] = p.w_a.x[i], a.w[1] = p.w_a.y[i], a.w[2] = p.w_a.z[i];
    }
    if (block.b[i] != 0) {
      Mover& b = movers[block.b[i]];
      b.v[0] = p.v_b.x[i], b.v[1] = p.v_b.y[i], b.v[2] = p.v_b.z[i];
      b.w[0] = p.w_b.x[i], b.w[1] = p.w_b.y[i], b.w[2] = p.w_b.z[i];
    }
  }
}
struct Turned {
  Vec dp, q;
  Lanes q_w;
};
AURASIM_INLINE Turned moved(const std::uint32_t (&who)[kLanes], const Mover* movers) {
  Turned t;
  for (int i = 0; i < kLanes; ++i) {
    const Mover& m = movers[who[i]];
    t.dp.x[i] = m.dp[0], t.dp.y[i] = m.dp[1], t.dp.z[i] = m.dp[2];
    t.q.x[i] = m.dq[0], t.q.y[i] = m.dq[1], t.q.z[i] = m.dq[2], t.q_w[i] = m.dq[3];
  }
  return t;
}
/// By how much the turn since the start of the step changes r.
AURASIM_INLINE Vec turn_of(const Turned& t, const Vec& r) {
  const Vec c = add(cross(t.q, r), mul(t.q_w, r));
  return mul(all(2), cross(t.q, c));
}
/// How far a point at r from the centre has come since the start of the step.
AURASIM_INLINE Vec way(const Turned& t, const Vec& r) { return add(t.dp, turn_of(t, r)); }
AURASIM_INLINE Vec speed(const Pair& p, const Vec& r_a, const Vec& r_b) {
  return sub(add(p.v_b, cross(p.w_b, r_b)), add(p.v_a, cross(p.w_a, r_a)));
}
template <class AnyBlock>
AURASIM_INLINE void push(Pair& p, const AnyBlock& block, const Vec& impulse, const Vec& r_a, const Vec& r_b) {
  p.v_a = sub(p.v_a, mul(block.inv_mass_a, impulse));
  p.w_a = sub(p.w_a, mul(block.inv_inertia_a, cross(r_a, impulse)));
  p.v_b = add(p.v_b, mul(block.inv_mass_b, impulse));
  p.w_b = add(p.w_b, mul(block.inv_inertia_b, cross(r_b, impulse)));
}
template <class AnyBlock>
AURASIM_INLINE void turn(Pair& p, const AnyBlock& block, const Vec& impulse) {
  p.w_a = sub(p.w_a, mul(block.inv_inertia_a, impulse));
  p.w_b = add(p.w_b, mul(block.inv_inertia_b, impulse));
}

}  // namespace
}  // namespace aurasim::physics::soft
