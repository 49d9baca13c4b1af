// The part of soft/kernel.h that solves contacts, in patches.
#pragma once

#include "physics/soft/kernel_vectors.h"

namespace aurasim::physics::soft {
namespace {

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

/// Solves the friction that resists a twist about the normal.
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
  const Lanes v_1 = dot(sliding, load(block.first)) + block.belt_1;
  const Lanes v_2 = dot(sliding, load(block.second)) + block.belt_2;
  const Lanes wanted_1 = block.rub_1 - (block.mass_11 * v_1 + block.mass_12 * v_2);
  const Lanes wanted_2 = block.rub_2 - (block.mass_12 * v_1 + block.mass_22 * v_2);
  const Lanes scale = share(root(wanted_1 * wanted_1 + wanted_2 * wanted_2), block.friction * pressed);
  const Lanes total_1 = scale * wanted_1, total_2 = scale * wanted_2;
  push(p, block, friction(block, total_1 - block.rub_1, total_2 - block.rub_2), r_a, r_b);
  block.rub_1 = total_1;
  block.rub_2 = total_2;
}

/// Solves the points along the normal. Returns the sum of their impulses.
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

/// Solves patches. No friction while overlaps are pushed apart: friction against the speed of a push would make piles
/// sway.
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

}  // namespace
}  // namespace aurasim::physics::soft
