#include "physics/soft/patches.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/progress.h"
#include "physics/prefetch.h"
#include "physics/soft/convert.h"
#include "physics/soft/exchange.h"

namespace aurasim::physics {
namespace {

using soft::Lanes;
using soft::Mover;
using soft::Real;

/// Frequencies of the contacts' springs, as shares of the substeps' rate and of the steps' rate; the lower one counts.
/// Springs stiffer than the first would oscillate. Springs stiffer than the second undo an overlap before the next look
/// for contacts, and card houses fall. Under a load of many times the weight of one body only the first counts. Springs
/// of statics are twice as stiff.
constexpr double kHertzOfSubsteps = 0.25, kHertzOfSteps = 1.5;
/// load, in weights of the lighter body, up to which both shares count, and from which on only the first does
constexpr Real kLight = 2, kHeavy = 10;
constexpr Real kDamping = 2;  ///< damping over critical damping: with 3 piles sway, with 1 cards wander
/// Points that approach more slowly than a body that falls for so many steps do not bounce: they rest.
constexpr Real kStepsOfRest = 2;
constexpr int kBounceSweeps = 8;  ///< several sweeps, because the points of a face share a bounce

struct Vec {
  Real x = 0, y = 0, z = 0;
};
Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(Real s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
Real dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(const Vec& a, const Vec& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Vec vec(const Real (&v)[3]) { return {v[0], v[1], v[2]}; }
/// Product with a symmetric matrix, stored as in SoftInertia.
Vec mul(const Real (&m)[6], const Vec& a) {
  return {m[0] * a.x + m[1] * a.y + m[2] * a.z, m[1] * a.x + m[3] * a.y + m[4] * a.z,
          m[2] * a.x + m[4] * a.y + m[5] * a.z};
}

void set(Lanes (&to)[3], int lane, const Vec& v) { to[0][lane] = v.x, to[1][lane] = v.y, to[2][lane] = v.z; }

Real inverse(Real x) { return x > 0 ? 1 / x : 0; }

/// The first direction across a normal. The second is the cross product of the two.
Vec across(const Vec& n) {
  const Vec t = std::abs(n.z) > Real(0.7) ? Vec{0, -n.z, n.y} : Vec{-n.y, n.x, 0};
  return 1 / std::sqrt(dot(t, t)) * t;
}

/// One side of a patch.
struct Side {
  const Mover& mover;
  const SoftInertia& inertia;

  Vec velocity_at(const Vec& r) const { return vec(mover.v) + cross(vec(mover.w), r); }
  /// How much an impulse along `u` at `r` changes the speed along `v` there, 1/kg.
  Real response(const Vec& r, const Vec& u, const Vec& v) const {
    return inertia.inv_mass * dot(u, v) + dot(cross(r, v), mul(inertia.inv_inertia, cross(r, u)));
  }
};

/// Speed along the normal when the gap has closed, m/s; negative: approaching. `gained`: energy from the fall until
/// then, J/kg.
Real approach(Real opening_m_s, Real gained) {
  if (opening_m_s >= 0) return opening_m_s;
  return -std::sqrt(std::max(Real(0), opening_m_s * opening_m_s + 2 * gained));
}

/// Inverse of a symmetric matrix; all 0 if it has none.
void invert(const Real (&m)[6], Real (&to)[6]) {
  const Real xx = m[3] * m[5] - m[4] * m[4], xy = m[2] * m[4] - m[1] * m[5], xz = m[1] * m[4] - m[2] * m[3];
  const Real per_det = inverse(m[0] * xx + m[1] * xy + m[2] * xz);
  to[0] = xx * per_det, to[1] = xy * per_det, to[2] = xz * per_det;
  to[3] = (m[0] * m[5] - m[2] * m[2]) * per_det, to[4] = (m[1] * m[2] - m[0] * m[4]) * per_det;
  to[5] = (m[0] * m[3] - m[1] * m[1]) * per_det;
}

}  // namespace

SoftInertia inertia_of(const btRigidBody& body) {
  SoftInertia inertia;
  inertia.inv_mass = static_cast<Real>(body.getInvMass());
  const btMatrix3x3& inverse = body.getInvInertiaTensorWorld();
  for (int row = 0, k = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) inertia.inv_inertia[k++] = static_cast<Real>(inverse[row][column]);
  }
  return inertia;
}

SoftPatches::SoftPatches(double step_s, int substeps)
    : step_s_(static_cast<Real>(step_s)),
      substep_s_(static_cast<Real>(step_s / substeps)),
      light_hertz_(static_cast<Real>(std::min(kHertzOfSubsteps * substeps, kHertzOfSteps) / step_s)),
      heavy_hertz_(static_cast<Real>(kHertzOfSubsteps * substeps / step_s)) {}

SoftPatches::Stiffness::Stiffness(Real hertz, Real substep_s) {
  const Real omega = 2 * std::numbers::pi_v<Real> * hertz;
  const Real a = 2 * kDamping + substep_s * omega;
  const Real b = substep_s * omega * a;
  rate_per_s = omega / a, mass = b / (1 + b), impulse = 1 / (1 + b);
}

/// Load of a patch: the last impulses over the weight of the lighter body.
Real SoftPatches::load(const SoftPatch& patch, Real inv_mass, Real gravity) const {
  Real pressed = 0;
  for (int i = 0; i < patch.count; ++i) pressed += patch.points[static_cast<std::size_t>(i)].impulse;
  return gravity > 0 ? pressed * inv_mass / (gravity * substep_s_) : 0;
}

void SoftPatches::clear(std::size_t movers, std::size_t patches) {
  patches_.resize(patches);
  layout_.clear(movers, soft::kMostPoints + 1, patches);
}

void SoftPatches::put(std::size_t i, SoftPatch& patch, std::int32_t a, std::int32_t b, SoftPhase phase,
                      std::size_t group) {
  patches_[i] = &patch;
  layout_.put(i, a, b, static_cast<std::size_t>(patch.count), phase, group);
}

void SoftPatches::build(const Mover* movers, const SoftInertia* inertias, const Real (&gravity)[3], soft::Team& team) {
  blocks_.resize(layout_.place(team));
  rest_m_s_ = kStepsOfRest * step_s_ * std::sqrt(dot(vec(gravity), vec(gravity)));
  may_bounce_.assign(blocks_.size(), 0);
  bounces_.assign(static_cast<std::size_t>(team.employed()), 0);
  team.side_by_side([&](const soft::Worker& worker) {
    const auto [first_block, last_block] = worker.share(blocks_.size());
    std::fill(blocks_.begin() + static_cast<std::ptrdiff_t>(first_block),
              blocks_.begin() + static_cast<std::ptrdiff_t>(last_block), soft::Block{});
    worker.wait();
    const auto [first, last] = worker.share(patches_.size());
    for (std::size_t i = first; i < last; ++i) {
      if (i + kPrefetchDistance / 2 < last) prefetch(patches_[i + kPrefetchDistance / 2], sizeof(SoftPatch));
      fill(i, movers, inertias, gravity);
      if (!may_bounce(i)) continue;
      std::atomic_ref(may_bounce_[layout_.block(i)]).store(1, std::memory_order_relaxed);
      bounces_[static_cast<std::size_t>(worker.number)] = 1;
    }
  });
}

void SoftPatches::fill(std::size_t at, const Mover* movers, const SoftInertia* inertias, const Real (&gravity)[3]) {
  const SoftPatch& patch = *patches_[at];
  soft::Block& block = blocks_[layout_.block(at)];
  const int lane = layout_.lane(at);
  const std::int32_t mover_a = layout_.a(at), mover_b = layout_.b(at);
  const SoftInertia &inertia_a = inertias[std::max(0, mover_a)], &inertia_b = inertias[std::max(0, mover_b)];
  const Side a{movers[mover_a], inertia_a}, b{movers[mover_b], inertia_b};
  const Vec n = vec(patch.normal), t1 = across(n), t2 = cross(n, t1);
  block.a[lane] = mover_a, block.b[lane] = mover_b;
  block.inv_mass_a[lane] = a.inertia.inv_mass, block.inv_mass_b[lane] = b.inertia.inv_mass;
  soft::set(block.inv_inertia_a, lane, a.inertia.inv_inertia);
  soft::set(block.inv_inertia_b, lane, b.inertia.inv_inertia);
  set(block.normal, lane, n), set(block.first, lane, t1), set(block.second, lane, t2);
  const Real borne =
      load(patch, std::max(a.inertia.inv_mass, b.inertia.inv_mass), std::sqrt(dot(vec(gravity), vec(gravity))));
  const Real heavy = std::clamp((borne - kLight) / (kHeavy - kLight), Real(0), Real(1));
  const Real hertz = light_hertz_ + heavy * std::max(Real(0), heavy_hertz_ - light_hertz_);
  const Stiffness stiff((mover_a > 0 && mover_b > 0 ? 1 : 2) * hertz, substep_s_);
  block.belt_1[lane] = dot(vec(patch.belt), t1), block.belt_2[lane] = dot(vec(patch.belt), t2);
  block.rate_per_s[lane] = stiff.rate_per_s, block.soft_mass[lane] = stiff.mass;
  block.soft_impulse[lane] = stiff.impulse;
  block.friction[lane] = patch.friction, block.restitution[lane] = patch.restitution;
  block.spinning_m[lane] = patch.spinning_m, block.rolling_m[lane] = patch.rolling_m;

  const Real fall_a = mover_a > 0 ? dot(vec(gravity), n) : 0, fall_b = mover_b > 0 ? dot(vec(gravity), n) : 0;
  Vec centre_a, centre_b;
  const auto count = static_cast<std::size_t>(patch.count);
  const Real share = 1 / static_cast<Real>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const SoftPatch::Point& point = patch.points[i];
    const Vec r_a = vec(point.r_a), r_b = vec(point.r_b);
    soft::Block::Point& to = block.points[i];
    set(to.r_a, lane, r_a), set(to.r_b, lane, r_b);
    to.gap[lane] = point.gap;
    to.mass[lane] = inverse(a.response(r_a, n, n) + b.response(r_b, n, n));
    to.impulse[lane] = point.impulse;
    to.approach[lane] = approach(dot(b.velocity_at(r_b) - a.velocity_at(r_a), n), (fall_a - fall_b) * point.gap);
    centre_a = centre_a + share * r_a, centre_b = centre_b + share * r_b;
  }
  Real lever_m = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec from = vec(patch.points[i].r_a) - centre_a;
    lever_m += std::sqrt(dot(from, from)) * share;
  }
  block.lever_m[lane] = lever_m;
  set(block.centre_a, lane, centre_a), set(block.centre_b, lane, centre_b);
  const Real k11 = a.response(centre_a, t1, t1) + b.response(centre_b, t1, t1);
  const Real k12 = a.response(centre_a, t1, t2) + b.response(centre_b, t1, t2);
  const Real k22 = a.response(centre_a, t2, t2) + b.response(centre_b, t2, t2);
  const Real per_det = inverse(k11 * k22 - k12 * k12);
  block.mass_11[lane] = k22 * per_det, block.mass_12[lane] = -k12 * per_det, block.mass_22[lane] = k11 * per_det;
  Real both[6], rolls[6];
  for (int i = 0; i < 6; ++i) both[i] = a.inertia.inv_inertia[i] + b.inertia.inv_inertia[i];
  block.mass_twist[lane] = inverse(dot(n, mul(both, n)));
  if (patch.rolling_m > 0) invert(both, rolls), soft::set(block.mass_roll, lane, rolls);
  block.rub_1[lane] = patch.rub_1, block.rub_2[lane] = patch.rub_2, block.twist[lane] = patch.twist;
}

void SoftPatches::warm_start(Mover* movers, const soft::Worker& worker) {
  if (worker.is_first()) core::Progress::mark();
  layout_.sweep(worker, 1, [&](int, std::size_t first, std::size_t count, std::size_t points) {
    soft::kernel().warm_start(&blocks_[first], count, static_cast<int>(points), movers);
  });
}

void SoftPatches::solve(Mover* movers, const soft::Substep& substep, SoftExchange* shared, const soft::Worker& worker) {
  if (worker.is_first()) core::Progress::mark();
  const auto work = [&](int, std::size_t first, std::size_t count, std::size_t points) {
    soft::kernel().solve(&blocks_[first], count, static_cast<int>(points), movers, substep);
  };
  if (shared == nullptr) return layout_.sweep(worker, 1, work);
  layout_.sweep_after(worker, work, [&](SoftPhase phase) { shared->exchange(phase, false, movers); });
}

void SoftPatches::bounce(Mover* movers, SoftExchange* shared, const soft::Worker& worker) {
  if (std::ranges::count(bounces_, 1) == 0) return;
  const auto work = [&](int, std::size_t first, std::size_t count, std::size_t points) {
    for (std::size_t k = first; k < first + count; ++k) {
      if (may_bounce_[k] != 0) {
        soft::kernel().bounce(&blocks_[k], 1, static_cast<int>(points), movers, rest_m_s_);
      }
    }
  };
  for (int sweep = 0; sweep < kBounceSweeps; ++sweep) {
    if (worker.is_first()) core::Progress::mark();
    if (shared == nullptr) {
      layout_.sweep(worker, 1, work);
    } else {
      layout_.sweep_after(worker, work, [&](SoftPhase phase) { shared->exchange(phase, true, movers); });
    }
  }
}

bool SoftPatches::may_bounce(std::size_t i) const {
  if (patches_[i]->restitution <= 0) return false;
  const soft::Block& block = blocks_[layout_.block(i)];
  const auto lane = layout_.lane(i);
  for (int k = 0; k < patches_[i]->count; ++k) {
    if (block.points[k].approach[lane] < -rest_m_s_) return true;
  }
  return false;
}

void SoftPatches::begin_tally(bool wanted) {
  tallies_ = wanted;
  sums_.assign(wanted ? blocks_.size() : 0, Sums{});
}

/// Contacts start from the impulses of the substep before, so the impulses at the end of a substep are all that acted
/// in it.
void SoftPatches::tally(const soft::Worker& worker) {
  if (!tallies_) return;
  const auto [first, last] = worker.share(blocks_.size());
  for (std::size_t i = first; i < last; ++i) {
    for (int k = 0; k < soft::kMostPoints; ++k) sums_[i].of[k] += blocks_[i].points[k].impulse;
  }
}

Real SoftPatches::tallied(std::size_t i, int point) const { return sums_[layout_.block(i)].of[point][layout_.lane(i)]; }

void SoftPatches::prefetch_impulses(const SoftPatch& patch) {
  if (patch.ahead || patch.is_foreign) return;
  for (int k = 0; k < patch.count; ++k) {
    physics::prefetch_impulses(patch.manifold->getContactPoint(patch.of[static_cast<std::size_t>(k)]));
  }
}

/// Impulses of friction belong to the patch. Each point gets them, in fields that Bullet keeps for a point that it
/// finds again, so they survive when a point is lost.
void SoftPatches::remember(soft::Team& team) const {
  team.side_by_side([&](const soft::Worker& worker) {
    const auto [first, last] = worker.share(patches_.size());
    for (std::size_t i = first; i < last; ++i) {
      if (i + kPrefetchDistance < last) prefetch_impulses(*patches_[i + kPrefetchDistance]);
      remember(i);
    }
  });
}

void SoftPatches::remember(std::size_t i) const {
  SoftPatch& patch = *patches_[i];
  if (patch.is_foreign) return;
  const soft::Block& block = blocks_[layout_.block(i)];
  const int lane = layout_.lane(i);
  for (int k = 0; k < patch.count; ++k) {
    if (patch.ahead) {
      patch.has_pressed = patch.has_pressed || block.points[k].most_impulse[lane] > 0;
      continue;
    }
    btManifoldPoint& point = patch.manifold->getContactPoint(patch.of[static_cast<std::size_t>(k)]);
    point.m_appliedImpulse = block.points[k].impulse[lane];
    point.m_appliedImpulseLateral1 = block.rub_1[lane];
    point.m_appliedImpulseLateral2 = block.rub_2[lane];
    point.m_prevRHS = block.twist[lane];
  }
}

}  // namespace aurasim::physics
