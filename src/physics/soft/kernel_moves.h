// The part of soft/kernel.h that integrates the poses of bodies.
#pragma once

#include "physics/soft/kernel_vectors.h"

namespace aurasim::physics::soft {
namespace {

/// A quaternion of any length.
struct Quaternion {
  Lanes v[3], w;
};
AURASIM_INLINE Vec vector_of(const Quaternion& q) { return load(q.v); }
/// The rotation b followed by a.
AURASIM_INLINE Quaternion mul(const Quaternion& a, const Quaternion& b) {
  const Vec u = vector_of(a), v = vector_of(b);
  const Vec w = add(add(mul(a.w, v), mul(b.w, u)), cross(u, v));
  return {{w.x, w.y, w.z}, a.w * b.w - dot(u, v)};
}
AURASIM_INLINE Quaternion conjugate(const Quaternion& q) { return {{-q.v[0], -q.v[1], -q.v[2]}, q.w}; }
AURASIM_INLINE Quaternion normalized(const Quaternion& q) {
  const Vec v = vector_of(q);
  const Lanes per_length = all(1) / root(dot(v, v) + q.w * q.w);
  return {{q.v[0] * per_length, q.v[1] * per_length, q.v[2] * per_length}, q.w * per_length};
}
/// Rotates r by q, which has length 1.
AURASIM_INLINE Vec rotate(const Quaternion& q, const Vec& r) {
  const Vec u = vector_of(q);
  return add(r, mul(all(2), cross(u, add(cross(u, r), mul(q.w, r)))));
}

/// Turns q by the rotation vector w h_s, to the second order.
AURASIM_INLINE Quaternion turn_evenly(const Quaternion& q, const Vec& w, Real h_s) {
  const Vec v = vector_of(q), half = mul(all(h_s / 2), w);
  const Vec turned = add(v, add(mul(q.w, half), cross(half, v)));
  return normalized({{turned.x, turned.y, turned.z}, q.w - dot(half, v)});
}

/// State of a free rotation, computed as a chain of turns about the body's axes, each the flow of one axis's kinetic
/// energy alone (physics/free_rotation.h has the source).
struct Chain {
  Lanes momentum[3];  ///< in the body's frame, N m s
  Quaternion q_WB;
};
AURASIM_INLINE void turn_about(Chain& c, int axis, const Lanes& inv_inertia, const Lanes& h_s) {
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  const Lanes angle = c.momentum[axis] * inv_inertia * h_s;
  const Lanes square = angle * angle;
  const Lanes s = angle / 2 * (all(1) + square / 12 * (all(1) + square / 10));  // tangent of half the angle
  const Lanes sine = 2 * s / (all(1) + s * s), cosine = all(1) - s * sine;
  const Lanes m_j = c.momentum[j], m_k = c.momentum[k];
  c.momentum[j] = cosine * m_j + sine * m_k;
  c.momentum[k] = cosine * m_k - sine * m_j;
  Quaternion& q = c.q_WB;
  const Lanes w = q.w, x = q.v[axis], y = q.v[j], z = q.v[k];
  q.w = w - s * x, q.v[axis] = x + s * w, q.v[j] = y + s * z, q.v[k] = z - s * y;
}

struct Motion {
  Quaternion dq;
  Vec w;
};

/// The free rotation in a substep, each lane in as many parts as its spin needs.
AURASIM_INLINE Motion tumble(const Motion& before, const Tumblers& t, Real h_s, const Turns& turns) {
  const Quaternion start = {{t.start[0], t.start[1], t.start[2]}, t.start[3]};
  const Quaternion q_WB = mul(before.dq, start);
  const Vec w_B = rotate(conjugate(q_WB), before.w);
  Chain chain = {{t.inertia[0] * w_B.x, t.inertia[1] * w_B.y, t.inertia[2] * w_B.z}, q_WB};
  const Vec momentum_B = load(chain.momentum);
  const Vec momentum_W = rotate(q_WB, momentum_B);
  const Lanes fastest =
      root(dot(momentum_B, momentum_B)) * max(t.inv_inertia[0], max(t.inv_inertia[1], t.inv_inertia[2]));
  const Lanes wanted = min(fastest * (h_s / turns.angle_rad), all(turns.most));
  Lanes parts = all(1);
  Real most_parts = 1;
  for (int i = 0; i < kLanes; ++i) {
    const auto whole = wanted[i] > 1 ? static_cast<Real>(static_cast<int>(wanted[i])) : Real(1);
    parts[i] = wanted[i] > whole ? whole + 1 : whole;
    most_parts = parts[i] > most_parts ? parts[i] : most_parts;
  }
  const Lanes part_s = all(h_s) / parts;
  for (Real done = 0; done < most_parts; ++done) {
    const Lanes h = all(done) < parts ? part_s : Lanes{};
    turn_about(chain, 0, t.inv_inertia[0], h / 2);
    turn_about(chain, 1, t.inv_inertia[1], h / 2);
    turn_about(chain, 2, t.inv_inertia[2], h);
    turn_about(chain, 1, t.inv_inertia[1], h / 2);
    turn_about(chain, 0, t.inv_inertia[0], h / 2);
  }
  const Quaternion after = normalized(chain.q_WB);
  const Vec m_B = rotate(conjugate(after), momentum_W);
  return {normalized(mul(after, conjugate(start))),
          rotate(after, {t.inv_inertia[0] * m_B.x, t.inv_inertia[1] * m_B.y, t.inv_inertia[2] * m_B.z})};
}

/// Moves the bodies that touch something by their speeds at the end of the substep (semi-implicit), which keeps piles
/// calm.
void move(Mover* movers, const Tumblers* tumblers, std::size_t first_row, std::size_t last_row, Real h_s,
          const Turns& turns) {
  for (std::size_t row = first_row; row < last_row; ++row) {
    const auto in_row = [row](int lane) { return row * kLanes + static_cast<std::size_t>(lane); };
    const Half speeds_before = load_half(in_row, movers, 0);
    const Turned before = turned(load_half(in_row, movers, 1));
    const Lanes(&c)[kLanes] = speeds_before.columns;
    const Vec dp = add(before.dp, mul(all(h_s), {c[0], c[1], c[2]}));
    const Motion now = {{{before.q.x, before.q.y, before.q.z}, before.q_w}, {c[3], c[4], c[5]}};
    Quaternion dq = turn_evenly(now.dq, now.w, h_s);
    const Tumblers& t = tumblers[row];
    if (t.any) {
      const Motion after = tumble(now, t, h_s, turns);
      const auto tumbles = t.inertia[0] > Lanes{};
      for (int i = 0; i < 3; ++i) dq.v[i] = tumbles ? after.dq.v[i] : dq.v[i];
      dq.w = tumbles ? after.dq.w : dq.w;
      const Vec w = {tumbles ? after.w.x : now.w.x, tumbles ? after.w.y : now.w.y, tumbles ? after.w.z : now.w.z};
      store_half(speeds({c[0], c[1], c[2]}, w), in_row, movers, 0);
    }
    store_half({{dp.x, dp.y, dp.z, dq.v[0], dq.v[1], dq.v[2], dq.w, Lanes{}}}, in_row, movers, 1);
  }
}

}  // namespace
}  // namespace aurasim::physics::soft
