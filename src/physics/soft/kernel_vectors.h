// Vectors of lanes and pairs of bodies, for the parts of soft/kernel.h.
#pragma once

#include "physics/soft/lanes.h"

/// Without forced inlining, calls would pass vectors through memory.
#define AURASIM_INLINE [[gnu::always_inline]] inline

namespace aurasim::physics::soft {
namespace {

struct Vec {
  Lanes x, y, z;
};
/// Velocities of two bodies.
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
/// Product with a symmetric matrix, stored as in Block.
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
/// Factor that limits an impulse of this length to `most`.
AURASIM_INLINE Lanes share(const Lanes& length, const Lanes& most) { return length > most ? most / length : all(1); }

/// Transposes in place: element i of row k becomes element k of row i.
AURASIM_INLINE void transpose(Lanes (&rows)[kLanes]) {
  static_assert(kLanes == 8);
  Lanes pairs[kLanes], fours[kLanes];
  for (int i = 0; i < kLanes; i += 2) {
    pairs[i] = __builtin_shufflevector(rows[i], rows[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    pairs[i + 1] = __builtin_shufflevector(rows[i], rows[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (int i = 0; i < kLanes; i += 4) {
    for (int k = 0; k < 2; ++k) {
      fours[i + 2 * k] = __builtin_shufflevector(pairs[i + k], pairs[i + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      fours[i + 2 * k + 1] = __builtin_shufflevector(pairs[i + k], pairs[i + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (int i = 0; i < kLanes / 2; ++i) {
    rows[i] = __builtin_shufflevector(fours[i], fours[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    rows[i + 4] = __builtin_shufflevector(fours[i], fours[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

static_assert(sizeof(Mover) == 2 * sizeof(Lanes) && __builtin_offsetof(Mover, dp) == sizeof(Lanes));
/// One half of kLanes movers, as columns: v and w, or dp and dq.
struct Half {
  Lanes columns[kLanes];
};
template <class Who>  // who(lane): index of the mover
AURASIM_INLINE Half load_half(const Who& who, const Mover* movers, std::size_t half) {
  Half h;
  for (int i = 0; i < kLanes; ++i) {
    __builtin_memcpy(&h.columns[i], reinterpret_cast<const Lanes*>(&movers[who(i)]) + half, sizeof(Lanes));
  }
  transpose(h.columns);
  return h;
}
/// Writes a half into movers. Skips mover 0, which never moves, and those below, the moving statics.
template <class Who>
AURASIM_INLINE void store_half(Half h, const Who& who, Mover* movers, std::size_t half) {
  transpose(h.columns);
  for (int i = 0; i < kLanes; ++i) {
    if (static_cast<std::ptrdiff_t>(who(i)) <= 0) continue;
    __builtin_memcpy(reinterpret_cast<Lanes*>(&movers[who(i)]) + half, &h.columns[i], sizeof(Lanes));
  }
}
AURASIM_INLINE auto those(const std::int32_t (&who)[kLanes]) {
  return [&who](int lane) { return who[lane]; };
}

AURASIM_INLINE Half speeds(const Vec& v, const Vec& w) { return {{v.x, v.y, v.z, w.x, w.y, w.z, Lanes{}, Lanes{}}}; }

template <class AnyBlock>
AURASIM_INLINE Pair velocities(const AnyBlock& block, const Mover* movers) {
  const Half a = load_half(those(block.a), movers, 0), b = load_half(those(block.b), movers, 0);
  const Lanes(&i)[kLanes] = a.columns;
  const Lanes(&k)[kLanes] = b.columns;
  return {{i[0], i[1], i[2]}, {i[3], i[4], i[5]}, {k[0], k[1], k[2]}, {k[3], k[4], k[5]}};
}
template <class AnyBlock>
AURASIM_INLINE void store(const Pair& p, const AnyBlock& block, Mover* movers) {
  store_half(speeds(p.v_a, p.w_a), those(block.a), movers, 0);
  store_half(speeds(p.v_b, p.w_b), those(block.b), movers, 0);
}
struct Turned {
  Vec dp, q;
  Lanes q_w;
};
AURASIM_INLINE Turned turned(const Half& h) {
  const Lanes(&c)[kLanes] = h.columns;
  return {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, c[6]};
}
AURASIM_INLINE Turned moved(const std::int32_t (&who)[kLanes], const Mover* movers) {
  return turned(load_half(those(who), movers, 1));
}
/// Change of the arm r by the turn since the start of the step.
AURASIM_INLINE Vec turn_of(const Turned& t, const Vec& r) {
  const Vec c = add(cross(t.q, r), mul(t.q_w, r));
  return mul(all(2), cross(t.q, c));
}
/// Displacement since the start of the step of a point at r from the centre.
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
