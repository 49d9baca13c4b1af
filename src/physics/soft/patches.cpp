#include "physics/soft/patches.h"

#include <algorithm>
#include <bit>
#include <numbers>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/prefetch.h"
#include "physics/soft/mover.h"

namespace aurasim::physics {
namespace {

using soft::kLanes;
using soft::Lanes;
using soft::Real;

/// Cosine of the angle between normals that count as one.
constexpr Real kSameNormal = Real(0.999);
/// Statics have colours of their own, which come last: what cannot give way has the last word.
constexpr int kColoursOfBodies = 40;
constexpr int kColours = 64;
constexpr std::uint64_t kOfBodies = (std::uint64_t{1} << kColoursOfBodies) - 1;

/// Springs, as a share of the substeps' rate: stiffer ones swing on their own. Of statics twice as stiff.
constexpr Real kHertzOfRate = Real(0.25);
constexpr Real kDamping = 1;  ///< critical: piles sway with more, too
/// What comes closer at less than this does not bounce.
constexpr Real kRestSpeed_m_s = Real(0.5);
constexpr int kBounceSweeps = 8;  ///< the points of a face share a bounce

btManifoldPoint& point_of(btPersistentManifold& manifold, int i) { return manifold.getContactPoint(i); }

soft::Kernel fastest_kernel() {
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) return soft::kernel_avx512();
  if (__builtin_cpu_supports("avx2")) return soft::kernel_avx2();
  return soft::kernel_sse2();
}

Real quadratic(const btMatrix3x3& m, const btVector3& a, const btVector3& b) { return a.dot(m * b); }

void set(Lanes (&to)[3], int lane, const btVector3& v) {
  for (int i = 0; i < 3; ++i) to[i][lane] = v[i];
}

void set(Lanes (&to)[6], int lane, const btMatrix3x3& m) {
  to[0][lane] = m[0][0], to[1][lane] = m[0][1], to[2][lane] = m[0][2];
  to[3][lane] = m[1][1], to[4][lane] = m[1][2], to[5][lane] = m[2][2];
}

/// One side of a patch.
struct Side {
  explicit Side(const btRigidBody* body) : body(body) {
    if (body == nullptr) return;
    inv_mass = body->getInvMass();
    inv_inertia = body->getInvInertiaTensorWorld();
    centre = body->getCenterOfMassPosition();
  }
  btVector3 velocity_at(const btVector3& r) const {
    return body != nullptr ? body->getVelocityInLocalPoint(r) : btVector3(0, 0, 0);
  }
  /// How much an impulse along `u` at `r` changes the speed along `v` there, 1/kg.
  Real response(const btVector3& r, const btVector3& u, const btVector3& v) const {
    return inv_mass * u.dot(v) + quadratic(inv_inertia, r.cross(u), r.cross(v));
  }

  const btRigidBody* body;
  Real inv_mass = 0;
  btMatrix3x3 inv_inertia{0, 0, 0, 0, 0, 0, 0, 0, 0};
  btVector3 centre{0, 0, 0};
};

Real inverse(Real x) { return x > 0 ? 1 / x : 0; }

}  // namespace

SoftPatches::SoftPatches(Real h_s)
    : kernel_(fastest_kernel()),
      of_bodies_(stiffness(kHertzOfRate / h_s, h_s)),
      of_statics_(stiffness(2 * kHertzOfRate / h_s, h_s)) {}

/// A spring and a damper that cannot overshoot in a substep, as a share of a rigid contact's impulse.
SoftPatches::Stiffness SoftPatches::stiffness(Real hertz, Real h_s) {
  const Real omega = 2 * std::numbers::pi_v<Real> * hertz;
  const Real a = 2 * kDamping + h_s * omega;
  const Real b = h_s * omega * a;
  return {omega / a, b / (1 + b), 1 / (1 + b)};
}

void SoftPatches::clear() {
  unsorted_.clear();
  used_.clear();
}

void SoftPatches::add(std::span<btPersistentManifold* const> manifolds) {
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    if (i + kPrefetchDistance < manifolds.size()) prefetch_head(*manifolds[i + kPrefetchDistance]);
    if (i + kPrefetchDistance / 2 < manifolds.size()) prefetch_points(*manifolds[i + kPrefetchDistance / 2]);
    const std::size_t first = unsorted_.size();
    split(*manifolds[i]);
    for (std::size_t k = first; k < unsorted_.size(); ++k) colour(unsorted_[k]);
  }
}

void SoftPatches::split(btPersistentManifold& manifold) {
  const std::size_t first = unsorted_.size();
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const btVector3& normal = point_of(manifold, i).m_normalWorldOnB;
    std::size_t k = first;
    while (k < unsorted_.size() &&
           point_of(manifold, unsorted_[k].points[0]).m_normalWorldOnB.dot(normal) < kSameNormal) {
      ++k;
    }
    if (k == unsorted_.size()) {
      unsorted_.push_back({&manifold, mover_of(*manifold.getBody0()), mover_of(*manifold.getBody1()), {}, 0, 0});
    }
    Patch& patch = unsorted_[k];
    patch.points[static_cast<std::size_t>(patch.count++)] = static_cast<std::int8_t>(i);
  }
}

/// The first that is free. Without one it is solved by itself, after the others.
void SoftPatches::colour(Patch& patch) {
  const std::uint32_t last = std::max(patch.a, patch.b);
  if (used_.size() <= last) used_.resize(last + 1, 0);
  used_[0] = 0;
  const bool of_bodies = patch.a != 0 && patch.b != 0;
  const std::uint64_t free = ~(used_[patch.a] | used_[patch.b]) & (of_bodies ? kOfBodies : ~kOfBodies);
  patch.colour = static_cast<std::int8_t>(std::countr_zero(free));
  if (free == 0) return;
  used_[patch.a] |= free & -free;
  used_[patch.b] |= free & -free;
}

/// By colour, then by the number of points, else as they came.
void SoftPatches::sort() {
  constexpr std::size_t kKinds = (kColours + 1) * (soft::kMostPoints + 1);
  std::array<std::uint32_t, kKinds + 1> first{};
  const auto kind = [](const Patch& p) {
    return static_cast<std::size_t>(p.colour) * (soft::kMostPoints + 1) + static_cast<std::size_t>(p.count);
  };
  for (const Patch& p : unsorted_) ++first[kind(p) + 1];
  for (std::size_t k = 0; k < kKinds; ++k) first[k + 1] += first[k];
  patches_.resize(unsorted_.size());
  for (const Patch& p : unsorted_) patches_[first[kind(p)]++] = p;
}

void SoftPatches::build(std::span<btRigidBody* const> bodies) {
  sort();
  runs_.clear();
  place_.resize(patches_.size());
  std::size_t blocks = 0;
  for (std::size_t i = 0; i < patches_.size();) {
    const Patch& head = patches_[i];
    const std::size_t abreast = head.colour == kColours ? 1 : kLanes;
    const std::size_t first = i;
    for (; i < patches_.size() && patches_[i].colour == head.colour && patches_[i].count == head.count; ++i) {
      const std::size_t nth = i - first;
      place_[i] = static_cast<std::uint32_t>((blocks + nth / abreast) * kLanes + nth % abreast);
    }
    const std::size_t count = (i - first + abreast - 1) / abreast;
    runs_.push_back({blocks, count, head.count});
    blocks += count;
  }
  blocks_.assign(blocks, soft::Block{});
  bounces_ = false;
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    if (i + kPrefetchDistance < patches_.size()) prefetch_points(*patches_[i + kPrefetchDistance].manifold);
    bounces_ = bounces_ || point_of(*patches_[i].manifold, patches_[i].points[0]).m_combinedRestitution > 0;
    fill(blocks_[place_[i] / kLanes], static_cast<int>(place_[i] % kLanes), patches_[i], bodies);
  }
}

void SoftPatches::fill(soft::Block& block, int lane, const Patch& patch, std::span<btRigidBody* const> bodies) const {
  const Side a(bodies[patch.a]), b(bodies[patch.b]);
  const btManifoldPoint& any = point_of(*patch.manifold, patch.points[0]);
  const btVector3 n = -any.m_normalWorldOnB;
  btVector3 t1, t2;
  btPlaneSpace1(n, t1, t2);
  block.a[lane] = patch.a, block.b[lane] = patch.b;
  block.inv_mass_a[lane] = a.inv_mass, block.inv_mass_b[lane] = b.inv_mass;
  set(block.inv_inertia_a, lane, a.inv_inertia);
  set(block.inv_inertia_b, lane, b.inv_inertia);
  set(block.normal, lane, n), set(block.first, lane, t1), set(block.second, lane, t2);
  const Stiffness& stiff = patch.a != 0 && patch.b != 0 ? of_bodies_ : of_statics_;
  block.rate_per_s[lane] = stiff.rate_per_s, block.soft_mass[lane] = stiff.mass;
  block.soft_impulse[lane] = stiff.impulse;
  block.friction[lane] = any.m_combinedFriction, block.restitution[lane] = any.m_combinedRestitution;
  block.spinning_m[lane] = any.m_combinedSpinningFriction, block.rolling_m[lane] = any.m_combinedRollingFriction;

  btVector3 centre_a(0, 0, 0), centre_b(0, 0, 0);
  const btManifoldPoint* oldest = &any;
  for (int i = 0; i < patch.count; ++i) {
    const btManifoldPoint& point = point_of(*patch.manifold, patch.points[static_cast<std::size_t>(i)]);
    if (point.m_lifeTime > oldest->m_lifeTime) oldest = &point;
    const btVector3 r_a = point.getPositionWorldOnA() - a.centre, r_b = point.getPositionWorldOnB() - b.centre;
    soft::Block::Point& to = block.points[i];
    set(to.r_a, lane, r_a), set(to.r_b, lane, r_b);
    to.gap[lane] = point.getDistance();
    to.mass[lane] = inverse(a.response(r_a, n, n) + b.response(r_b, n, n));
    to.impulse[lane] = point.m_appliedImpulse;
    to.approach[lane] = (b.velocity_at(r_b) - a.velocity_at(r_a)).dot(n);
    centre_a += r_a / patch.count, centre_b += r_b / patch.count;
  }
  for (int i = 0; i < patch.count; ++i) {
    const auto& r = block.points[i].r_a;
    block.lever_m[lane] += (btVector3(r[0][lane], r[1][lane], r[2][lane]) - centre_a).length() / patch.count;
  }
  set(block.centre_a, lane, centre_a), set(block.centre_b, lane, centre_b);
  const Real k11 = a.response(centre_a, t1, t1) + b.response(centre_b, t1, t1);
  const Real k12 = a.response(centre_a, t1, t2) + b.response(centre_b, t1, t2);
  const Real k22 = a.response(centre_a, t2, t2) + b.response(centre_b, t2, t2);
  const Real per_det = inverse(k11 * k22 - k12 * k12);
  block.mass_11[lane] = k22 * per_det, block.mass_12[lane] = -k12 * per_det, block.mass_22[lane] = k11 * per_det;
  const btMatrix3x3 both = a.inv_inertia + b.inv_inertia;
  block.mass_twist[lane] = inverse(quadratic(both, n, n));
  if (block.rolling_m[lane] > 0 && both.determinant() > 0) set(block.mass_roll, lane, both.inverse());
  block.rub_1[lane] = oldest->m_appliedImpulseLateral1, block.rub_2[lane] = oldest->m_appliedImpulseLateral2;
  block.twist[lane] = oldest->m_prevRHS;
}

void SoftPatches::warm_start(soft::Mover* movers) {
  for (const Run& run : runs_) kernel_.warm_start(&blocks_[run.first], run.count, run.points, movers);
}

void SoftPatches::solve(soft::Mover* movers, const soft::Substep& substep) {
  for (const Run& run : runs_) kernel_.solve(&blocks_[run.first], run.count, run.points, movers, substep);
}

void SoftPatches::bounce(soft::Mover* movers) {
  for (int sweep = 0; sweep < kBounceSweeps && bounces_; ++sweep) {
    for (const Run& run : runs_) {
      kernel_.bounce(&blocks_[run.first], run.count, run.points, movers, -kRestSpeed_m_s);
    }
  }
}

/// The impulses of friction are the patch's. Each point has them, in the fields that Bullet keeps for a point that it
/// finds again, so that they are still there when one of them is lost.
void SoftPatches::remember() const {
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    const soft::Block& block = blocks_[place_[i] / kLanes];
    const auto lane = static_cast<int>(place_[i] % kLanes);
    for (int k = 0; k < patches_[i].count; ++k) {
      btManifoldPoint& point = point_of(*patches_[i].manifold, patches_[i].points[static_cast<std::size_t>(k)]);
      point.m_appliedImpulse = block.points[k].impulse[lane];
      point.m_appliedImpulseLateral1 = block.rub_1[lane];
      point.m_appliedImpulseLateral2 = block.rub_2[lane];
      point.m_prevRHS = block.twist[lane];
    }
  }
}

}  // namespace aurasim::physics
