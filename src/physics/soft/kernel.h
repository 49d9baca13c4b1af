// The arithmetic that soft/lanes.h declares. For the files that compile it for one set of instructions, and no others.
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

AURASIM_INLINE Pair velocities(const Block& block, const Mover* movers) {
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
AURASIM_INLINE void store(const Pair& p, const Block& block, Mover* movers) {
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
/// How far a point at r from the centre has come since the start of the step.
AURASIM_INLINE Vec way(const Turned& t, const Vec& r) {
  const Vec c = add(cross(t.q, r), mul(t.q_w, r));
  return add(t.dp, mul(all(2), cross(t.q, c)));
}
AURASIM_INLINE Vec speed(const Pair& p, const Vec& r_a, const Vec& r_b) {
  return sub(add(p.v_b, cross(p.w_b, r_b)), add(p.v_a, cross(p.w_a, r_a)));
}
AURASIM_INLINE void push(Pair& p, const Block& block, const Vec& impulse, const Vec& r_a, const Vec& r_b) {
  p.v_a = sub(p.v_a, mul(block.inv_mass_a, impulse));
  p.w_a = sub(p.w_a, mul(block.inv_inertia_a, cross(r_a, impulse)));
  p.v_b = add(p.v_b, mul(block.inv_mass_b, impulse));
  p.w_b = add(p.w_b, mul(block.inv_inertia_b, cross(r_b, impulse)));
}
AURASIM_INLINE void turn(Pair& p, const Block& block, const Vec& impulse) {
  p.w_a = sub(p.w_a, mul(block.inv_inertia_a, impulse));
  p.w_b = add(p.w_b, mul(block.inv_inertia_b, impulse));
}
AURASIM_INLINE Vec friction(const Block& block, const Lanes& first, const Lanes& second) {
  return add(mul(first, load(block.first)), mul(second, load(block.second)));
}

void warm_start(const Block* blocks, std::size_t count, int points, Mover* movers) {
  for (std::size_t k = 0; k < count; ++k) {
    const Block& block = blocks[k];
    Pair p = velocities(block, movers);
    const Vec n = load(block.normal);
    for (int i = 0; i < points; ++i) {
      const auto& point = block.points[i];
      push(p, block, mul(point.impulse, n), load(point.r_a), load(point.r_b));
    }
    push(p, block, friction(block, block.rub_1, block.rub_2), load(block.centre_a), load(block.centre_b));
    turn(p, block, add(mul(block.twist, n), load(block.roll)));
    store(p, block, movers);
  }
}

/// Friction about the normal.
AURASIM_INLINE void rub_twist(Block& block, Pair& p, const Lanes& pressed) {
  const Vec n = load(block.normal);
  const Lanes most = pressed * (block.friction * block.lever_m + block.spinning_m);
  const Lanes total = max(-most, min(most, block.twist - block.mass_twist * dot(sub(p.w_b, p.w_a), n)));
  turn(p, block, mul(total - block.twist, n));
  block.twist = total;
}

AURASIM_INLINE void rub_roll(Block& block, Pair& p, const Lanes& pressed) {
  const Vec before = load(block.roll);
  const Vec wanted = sub(before, mul(block.mass_roll, sub(p.w_b, p.w_a)));
  const Vec total = mul(share(root(dot(wanted, wanted)), pressed * block.rolling_m), wanted);
  turn(p, block, sub(total, before));
  block.roll[0] = total.x, block.roll[1] = total.y, block.roll[2] = total.z;
}

AURASIM_INLINE void rub(Block& block, Pair& p, const Lanes& pressed) {
  const Vec r_a = load(block.centre_a), r_b = load(block.centre_b);
  const Vec sliding = speed(p, r_a, r_b);
  const Lanes v_1 = dot(sliding, load(block.first)), v_2 = dot(sliding, load(block.second));
  const Lanes wanted_1 = block.rub_1 - (block.mass_11 * v_1 + block.mass_12 * v_2);
  const Lanes wanted_2 = block.rub_2 - (block.mass_12 * v_1 + block.mass_22 * v_2);
  const Lanes scale = share(root(wanted_1 * wanted_1 + wanted_2 * wanted_2), block.friction * pressed);
  const Lanes total_1 = scale * wanted_1, total_2 = scale * wanted_2;
  push(p, block, friction(block, total_1 - block.rub_1, total_2 - block.rub_2), r_a, r_b);
  block.rub_1 = total_1;
  block.rub_2 = total_2;
}

/// Along the normal; returns the sum of the impulses.
AURASIM_INLINE Lanes press(Block& block, Pair& p, int points, const Mover* movers, const Substep& substep) {
  const Lanes zero{};
  const Vec n = load(block.normal);
  const Turned moved_a = moved(block.a, movers), moved_b = moved(block.b, movers);
  Lanes pressed = zero;
  for (int i = 0; i < points; ++i) {
    auto& point = block.points[i];
    const Vec r_a = load(point.r_a), r_b = load(point.r_b);
    const Lanes gap = point.gap + dot(sub(way(moved_b, r_b), way(moved_a, r_a)), n);
    const auto apart = gap > zero;
    Lanes bias = apart ? gap * substep.per_s : zero, mass = all(1), give = zero;
    if (substep.pushes) {
      bias = apart ? bias : max(block.rate_per_s * gap, all(-substep.top_push_m_s));
      mass = apart ? mass : block.soft_mass;
      give = apart ? give : block.soft_impulse;
    }
    const Lanes opening = dot(speed(p, r_a, r_b), n);
    const Lanes total = max(point.impulse - point.mass * mass * (opening + bias) - give * point.impulse, zero);
    push(p, block, mul(total - point.impulse, n), r_a, r_b);
    point.impulse = total;
    point.most_impulse = max(point.most_impulse, total);
    pressed = pressed + total;
  }
  return pressed;
}

/// Friction against the speed of a push would feed the swaying of a pile.
void solve(Block* blocks, std::size_t count, int points, Mover* movers, const Substep& substep) {
  for (std::size_t k = 0; k < count; ++k) {
    Block& block = blocks[k];
    Pair p = velocities(block, movers);
    const Lanes pressed = press(block, p, points, movers, substep);
    if (!substep.pushes) {
      rub_twist(block, p, pressed);
      rub_roll(block, p, pressed);
      rub(block, p, pressed);
    }
    store(p, block, movers);
  }
}

void bounce(Block* blocks, std::size_t count, int points, Mover* movers, Real threshold_m_s) {
  const Lanes zero{};
  for (std::size_t k = 0; k < count; ++k) {
    Block& block = blocks[k];
    Pair p = velocities(block, movers);
    const Vec n = load(block.normal);
    for (int i = 0; i < points; ++i) {
      auto& point = block.points[i];
      const Vec r_a = load(point.r_a), r_b = load(point.r_b);
      const Lanes closing = dot(speed(p, r_a, r_b), n);
      const Lanes wanted = max(point.impulse - point.mass * (closing + block.restitution * point.approach), zero);
      const auto bounces =
          (point.approach < all(-threshold_m_s)) & (point.most_impulse > zero) & (block.restitution > zero);
      const Lanes total = bounces ? wanted : point.impulse;
      push(p, block, mul(total - point.impulse, n), r_a, r_b);
      point.impulse = total;
      point.most_impulse = max(point.most_impulse, total);
    }
    store(p, block, movers);
  }
}

constexpr Kernel kThis = {warm_start, solve, bounce};

}  // namespace
}  // namespace aurasim::physics::soft
