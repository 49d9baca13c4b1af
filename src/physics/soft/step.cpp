#include "physics/soft/step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/progress.h"
#include "physics/bullet_convert.h"
#include "physics/contact_impulses.h"
#include "physics/free_rotation.h"
#include "physics/moving_body.h"
#include "physics/prefetch.h"
#include "physics/settings.h"
#include "physics/soft/convert.h"
#include "physics/soft/flight.h"
#include "physics/soft/joints.h"
#include "physics/soft/patches.h"
#include "physics/soft/seams.h"
#include "physics/soft/shared.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {
namespace {

using soft::Mover;
using soft::Real;

/// Highest speed at which overlaps are pushed apart.
constexpr Real kTopPush_m_s = 3;
/// Sweeps over joints in each substep: before contacts (several, because their impulses start from 0), and after bodies
/// have moved.
constexpr int kJointSweeps = 4, kLastJointSweeps = 2;

}  // namespace

struct SoftStep::Impl {
  static constexpr std::int32_t kHeld = -1;

  Impl(const Settings& settings, soft::Team& its_team)
      : team(its_team),
        step_s(static_cast<btScalar>(settings.step_s)),
        h_s(static_cast<Real>(settings.step_s / settings.substeps)),
        substeps(settings.substeps),
        block_m(settings.block_m),
        patches(settings.step_s, settings.substeps),
        joints(settings.step_s / settings.substeps) {}

  /// Body of a mover at the start of the step.
  struct Body {
    btVector3 p{0, 0, 0};
    btQuaternion q{0, 0, 0, 1};
    btVector3 v{0, 0, 0}, w{0, 0, 0};
  };
  /// A mover, and what its velocities gain in each substep.
  struct PushedMover {
    std::size_t mover;
    Real v[3], w[3];
  };
  struct alignas(64) PushedMovers {
    std::vector<PushedMover> all;  ///< ascending mover
  };
  struct Held {
    btRigidBody* body;
    std::size_t group;
  };

  bool is_held(int user_index) const {
    const auto place = static_cast<std::size_t>(user_index);
    return user_index >= 0 && place < mover_at.size() && mover_at[place] != 0;
  }
  /// Index of a body's mover. Negative for moving statics, 0 for other statics and for sleepers.
  std::int32_t mover_of(int user_index) const {
    const auto of_static = static_cast<std::size_t>(-1 - user_index);
    if (user_index < 0) return of_static < mover_of_static.size() ? mover_of_static[of_static] : 0;
    return is_held(user_index) ? std::max(0, mover_at[static_cast<std::size_t>(user_index)]) : 0;
  }
  void take_in(std::span<btRigidBody* const> awake, std::span<btRigidBody* const> moving_statics,
               std::span<const SoftTouch> touches, std::span<btTypedConstraint* const> joint_list);
  void take_in_shared(std::span<const SoftTouch> touches, SoftContacts& contacts);
  void make_room(std::size_t moving_statics);
  void take_in_statics(std::span<btRigidBody* const> moving_statics);
  void hold(int user_index);
  void order_by_block();
  void take_in(std::size_t i);
  void take_in_row(std::size_t row);
  void take_in_pushes(std::size_t first, std::size_t last, std::vector<PushedMover>& pushes) const;
  void take_in_patches(std::span<const SoftTouch> touches, SoftContacts& contacts);
  void take_in_joints(std::span<btTypedConstraint* const> joint_list);
  SoftPhase phase_of(std::int32_t a, std::int32_t b) const;
  void show(std::size_t i) const;
  void prefetch_after(std::size_t i) const;
  void run(const soft::Worker& worker);
  void tell(ContactImpulses& impulses) const;

  soft::Team& team;
  btScalar step_s;
  Real h_s;
  int substeps;
  double block_m;
  btVector3 gravity{0, 0, 0};
  SoftShared* shared = nullptr;
  /// by user index; 0: touches nothing; kHeld: touches something and has no mover yet
  std::vector<std::int32_t> mover_at;
  std::vector<std::int32_t> mover_of_static;  ///< by -1 - user index; 0: it stands
  std::vector<btRigidBody*> flying;
  std::vector<btRigidBody*> held;  ///< bodies by mover; block by block, if there are several threads
  std::vector<Held> unordered;
  /// in whole rows: an empty row and those of moving statics, if any; then those of bodies
  std::vector<Mover> all_movers;
  /// movers of bodies, the first of which never moves; those of moving statics lie before them
  Mover* movers = nullptr;
  std::vector<soft::Tumblers> steady;       ///< by row of moving statics
  std::vector<soft::Tumblers> tumblers;     ///< by row of bodies
  std::vector<SoftInertia> inertias;        ///< by mover
  std::vector<Body> bodies;                 ///< by mover
  std::vector<SoftPlace> places;            ///< by mover
  std::vector<PushedMovers> pushes;         ///< by thread
  std::vector<std::size_t> patches_before;  ///< by thread: number of patches of the threads before it
  SoftPatches patches;
  SoftJoints joints;
};

SoftStep::SoftStep(const Settings& settings, soft::Team& team) : impl_(std::make_unique<Impl>(settings, team)) {}
SoftStep::~SoftStep() = default;

void SoftStep::Impl::hold(int user_index) {
  if (user_index < 0) return;
  const auto place = static_cast<std::size_t>(user_index);
  if (mover_at.size() <= place) mover_at.resize(place + 1, 0);
  mover_at[place] = kHeld;
}

/// Makes the movers. Bodies that touch nothing and have no joint are moved at once.
void SoftStep::Impl::take_in(std::span<btRigidBody* const> awake, std::span<btRigidBody* const> moving_statics,
                             std::span<const SoftTouch> touches, std::span<btTypedConstraint* const> joint_list) {
  mover_at.clear();
  for (const SoftTouch& touch : touches) hold(touch.a), hold(touch.b);
  for (const btTypedConstraint* joint : joint_list) {
    hold(joint->getRigidBodyA().getUserIndex()), hold(joint->getRigidBodyB().getUserIndex());
  }
  held.assign(1, nullptr);
  flying.clear();
  for (btRigidBody* body : awake) {
    if (is_held(body->getUserIndex())) {
      held.push_back(body);
    } else if (!is_guest(*body)) {
      flying.push_back(body);
    }
  }
  if (team.employed() > 1) order_by_block();
  if (shared != nullptr) shared->make_room(held);
  make_room(moving_statics.size());
  take_in_statics(moving_statics);
  team.side_by_side([this](const soft::Worker& worker) {
    const auto [first_flying, last_flying] = worker.share(flying.size());
    for (std::size_t i = first_flying; i < last_flying; ++i) fly(*flying[i], gravity, step_s);
    const auto [first, last] = worker.share(tumblers.size());
    for (std::size_t row = first; row < last; ++row) take_in_row(row);
    take_in_pushes(first * soft::kLanes, last * soft::kLanes, pushes[static_cast<std::size_t>(worker.number)].all);
  });
  if (shared != nullptr) shared->take_in(movers, inertias);
}

/// Sorts the bodies by block, so that what a thread works on lies together. The order of movers changes no bit.
void SoftStep::Impl::order_by_block() {
  unordered.resize(held.size());
  team.for_each(held.size() - 1, [this](std::size_t i) {
    unordered[i + 1] = {held[i + 1], group_of(SoftPhase::kInside, {.block = place_of(*held[i + 1]).block})};
  });
  std::array<std::size_t, kSoftGroups + 1> next{};
  for (std::size_t i = 1; i < held.size(); ++i) ++next[unordered[i].group + 1];
  next[0] = 1;
  for (std::size_t group = 1; group < kSoftGroups; ++group) next[group] += next[group - 1];
  for (std::size_t i = 1; i < held.size(); ++i) held[next[unordered[i].group]++] = unordered[i].body;
}

void SoftStep::Impl::make_room(std::size_t moving_statics) {
  const auto rows = [](std::size_t count) { return (count + soft::kLanes - 1) / soft::kLanes; };
  held.resize(rows(held.size()) * soft::kLanes, nullptr);
  steady.assign(moving_statics > 0 ? 1 + rows(moving_statics) : 0, soft::Tumblers{});
  all_movers.resize(steady.size() * soft::kLanes + held.size());
  movers = all_movers.data() + steady.size() * soft::kLanes;
  tumblers.resize(held.size() / soft::kLanes);
  inertias.resize(held.size());
  bodies.resize(held.size());
  places.resize(held.size());
  pushes.resize(static_cast<std::size_t>(team.size()));
}

/// Makes the movers of moving statics. They go on evenly, whatever they touch.
void SoftStep::Impl::take_in_statics(std::span<btRigidBody* const> moving_statics) {
  mover_of_static.clear();
  std::fill(all_movers.data(), movers, Mover{});
  for (std::size_t i = 0; i < moving_statics.size(); ++i) {
    const auto mover = -1 - static_cast<std::int32_t>(i);
    const auto place = static_cast<std::size_t>(-1 - moving_statics[i]->getUserIndex());
    if (mover_of_static.size() <= place) mover_of_static.resize(place + 1, 0);
    mover_of_static[place] = mover;
    soft::from_bullet(moving_statics[i]->getLinearVelocity(), movers[mover].v);
    soft::from_bullet(moving_statics[i]->getAngularVelocity(), movers[mover].w);
  }
}

/// Of movers [first, last).
void SoftStep::Impl::take_in_pushes(std::size_t first, std::size_t last, std::vector<PushedMover>& of_thread) const {
  of_thread.clear();
  for (std::size_t i = std::max<std::size_t>(1, first); i < last && held[i] != nullptr; ++i) {
    const Pushed push = pushed(*held[i]);
    if (!push.any) continue;
    PushedMover& mover = of_thread.emplace_back();
    mover.mover = i;
    soft::from_bullet(push.v * btScalar(h_s), mover.v);
    soft::from_bullet(push.w * btScalar(h_s), mover.w);
  }
}

/// Lists the patches in the order of touches.
void SoftStep::Impl::take_in_patches(std::span<const SoftTouch> touches, SoftContacts& contacts) {
  patches_before.assign(static_cast<std::size_t>(team.employed()) + 1, 0);
  team.side_by_side([&](const soft::Worker& worker) {
    const std::size_t number = static_cast<std::size_t>(worker.number);
    const auto [first, last] = worker.share(touches.size());
    std::size_t count = 0;
    for (std::size_t i = first; i < last; ++i) count += touches[i].patches;
    patches_before[number + 1] = count;
    worker.wait();
    if (worker.is_first()) {
      std::partial_sum(patches_before.begin(), patches_before.end(), patches_before.begin());
      patches.clear(held.size(), patches_before.back());
    }
    worker.wait();
    std::size_t next = patches_before[number];
    for (std::size_t i = first; i < last; ++i) {
      const std::int32_t a = mover_of(touches[i].a), b = mover_of(touches[i].b);
      const SoftPhase phase = phase_of(a, b);
      const std::size_t group = group_of(phase, places[static_cast<std::size_t>(std::max(0, a))]);
      for (SoftPatch& patch : contacts.patches_of(touches[i])) patches.put(next++, patch, a, b, phase, group);
    }
  });
}

/// Lists the patches, with those of chains of contacts over several regions at the end.
void SoftStep::Impl::take_in_shared(std::span<const SoftTouch> touches, SoftContacts& contacts) {
  shared->begin();
  for (const SoftTouch& touch : touches) {
    const std::int32_t a = mover_of(touch.a), b = mover_of(touch.b);
    const SoftPhase phase = phase_of(a, b);
    const std::size_t group = group_of(phase, places[static_cast<std::size_t>(std::max(0, a))]);
    shared->add(touch, contacts.patches_of(touch), a, b, phase, group);
  }
  shared->settle();
  const std::span<const SoftShared::Placed> placed = shared->placed();
  patches.clear(held.size(), placed.size());
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const SoftShared::Placed& one = placed[i];
    patches.put(i, *one.patch, one.a, one.b, one.phase, one.group);
  }
}

void SoftStep::Impl::take_in_joints(std::span<btTypedConstraint* const> joint_list) {
  joints.clear(joint_list.size());
  team.side_by_side([&](const soft::Worker& worker) {
    const auto [first, last] = worker.share(joint_list.size());
    for (std::size_t i = first; i < last; ++i) {
      if (i + kPrefetchDistance < last) prefetch(joint_list[i + kPrefetchDistance], sizeof(btTypedConstraint));
      if (i + kPrefetchDistance / 2 < last) SoftJoints::prefetch_parts(*joint_list[i + kPrefetchDistance / 2]);
      btTypedConstraint& joint = *joint_list[i];
      joints.put(i, joint, mover_of(joint.getRigidBodyA().getUserIndex()),
                 mover_of(joint.getRigidBodyB().getUserIndex()));
    }
  });
}

/// Contacts with statics have a phase of their own, whatever this returns for them.
SoftPhase SoftStep::Impl::phase_of(std::int32_t a, std::int32_t b) const {
  if (a <= 0 || b <= 0) return SoftPhase::kInside;
  return physics::phase_of(places[static_cast<std::size_t>(a)], places[static_cast<std::size_t>(b)]);
}

void SoftStep::Impl::take_in_row(std::size_t row) {
  tumblers[row] = {};
  for (std::size_t i = row * soft::kLanes; i < (row + 1) * soft::kLanes; ++i) take_in(i);
}

void SoftStep::Impl::prefetch_after(std::size_t i) const {
  const std::size_t next = i + kPrefetchDistance / 4;
  if (next < held.size() && held[next] != nullptr) prefetch_motion(*held[next]);
}

void SoftStep::Impl::take_in(std::size_t i) {
  Mover& mover = movers[i] = {};
  inertias[i] = {};
  if (held[i] == nullptr) {
    bodies[i] = {};
    return;
  }
  prefetch_after(i);
  const btRigidBody& body = *held[i];
  mover_at[static_cast<std::size_t>(body.getUserIndex())] = static_cast<std::int32_t>(i);
  soft::from_bullet(body.getLinearVelocity(), mover.v);
  soft::from_bullet(body.getAngularVelocity(), mover.w);
  inertias[i] = inertia_of(body);
  const btTransform& start = body.getWorldTransform();
  bodies[i] = {start.getOrigin(), start.getRotation(), body.getLinearVelocity(), body.getAngularVelocity()};
  const BodyPlace& place = place_of(body);
  places[i] = soft_place(from_bullet(start.getOrigin()), place.block, place.radius_m, block_m);
  const std::optional<core::Vec3> tumbling = tumbling_inertia(body);
  if (!tumbling) return;
  soft::Tumblers& row = tumblers[i / soft::kLanes];
  const auto lane = static_cast<int>(i % soft::kLanes);
  row.any = true;
  for (int k = 0; k < 4; ++k) row.start[k][lane] = static_cast<Real>(bodies[i].q[k]);
  for (int k = 0; k < 3; ++k) {
    row.inertia[k][lane] = static_cast<Real>((*tumbling)[k]);
    row.inv_inertia[k][lane] = 1 / row.inertia[k][lane];
  }
}

void SoftStep::Impl::run(const soft::Worker& worker) {
  const auto [first_row, last_row] = worker.share(tumblers.size());
  const Real fall[3] = {h_s * static_cast<Real>(gravity[0]), h_s * static_cast<Real>(gravity[1]),
                        h_s * static_cast<Real>(gravity[2])};
  joints.look(movers, worker);
  soft::Substep substep{1 / h_s, kTopPush_m_s, true};
  for (int s = 0; s < substeps; ++s) {
    for (std::size_t i = std::max<std::size_t>(1, first_row * soft::kLanes); i < last_row * soft::kLanes; ++i) {
      for (int k = 0; k < 3; ++k) movers[i].v[k] += fall[k];
    }
    for (const PushedMover& push : pushes[static_cast<std::size_t>(worker.number)].all) {
      for (int k = 0; k < 3; ++k) movers[push.mover].v[k] += push.v[k], movers[push.mover].w[k] += push.w[k];
    }
    worker.wait();
    patches.warm_start(movers, worker);
    joints.begin_and_solve(movers, kJointSweeps, worker);
    substep.pushes = true;
    patches.solve(movers, substep, shared, worker);
    soft::kernel().move(movers, tumblers.data(), first_row, last_row, h_s,
                        {static_cast<Real>(kTurn), Real{kMostTurns}});
    if (worker.is_first()) {
      soft::kernel().move(all_movers.data(), steady.data(), 1, std::max<std::size_t>(1, steady.size()), h_s, {});
    }
    worker.wait();
    joints.look_and_solve(movers, kLastJointSweeps, worker);
    substep.pushes = false;
    patches.solve(movers, substep, shared, worker);
    if (s + 1 < substeps) patches.tally(worker);
  }
  patches.bounce(movers, shared, worker);
  patches.tally(worker);
}

/// Adds the contact impulses at the contact points of the start of the step.
void SoftStep::Impl::tell(ContactImpulses& impulses) const {
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const SoftPatch& patch = patches.patch(i);
    const std::int32_t a = patches.mover_a(i), b = patches.mover_b(i);
    if (patch.is_foreign) continue;
    for (int k = 0; k < patch.count; ++k) {
      const SoftPatch::Point& point = patch.points[static_cast<std::size_t>(k)];
      const btVector3& centre = bodies[static_cast<std::size_t>(a > 0 ? a : b)].p;
      const btVector3 p = centre + soft::to_bullet(a > 0 ? point.r_a : point.r_b);
      impulses.add(patch.a, patch.b, p, soft::to_bullet(patch.normal), static_cast<double>(patches.tallied(i, k)));
    }
  }
}

/// Writes pose and velocities of a mover into its body. Adds only their changes, so the rounding of a mover's speed at
/// the start is not lost.
void SoftStep::Impl::show(std::size_t i) const {
  const Mover& m = movers[i];
  const Body& body = bodies[i];
  if (held[i] == nullptr || is_guest(*held[i])) return;
  prefetch_after(i);
  const auto after = [](const btVector3& before, const Real(&now)[3]) {
    btVector3 v(0, 0, 0);
    for (int k = 0; k < 3; ++k) v[k] = before[k] + (btScalar(now[k]) - btScalar(static_cast<Real>(before[k])));
    return v;
  };
  held[i]->setLinearVelocity(after(body.v, m.v));
  held[i]->setAngularVelocity(after(body.w, m.w));
  const btQuaternion turned(m.dq[0], m.dq[1], m.dq[2], m.dq[3]);
  move_to(*held[i], btTransform((turned * body.q).normalized(), body.p + soft::to_bullet(m.dp)));
}

void SoftStep::solve(std::span<btRigidBody* const> bodies, std::span<btRigidBody* const> moving_statics,
                     std::span<const SoftTouch> touches, SoftContacts& contacts,
                     std::span<btTypedConstraint* const> joints, const btVector3& gravity, ContactImpulses& impulses,
                     SoftShared* shared) {
  Impl& impl = *impl_;
  impl.shared = shared;
  impl.gravity = gravity;
  impl.take_in(bodies, moving_statics, touches, joints);
  if (shared != nullptr) {
    impl.take_in_shared(touches, contacts);
  } else {
    impl.take_in_patches(touches, contacts);
  }
  Real pull[3];
  soft::from_bullet(gravity, pull);
  impl.patches.build(impl.movers, impl.inertias.data(), pull, impl.team);
  if (shared != nullptr) shared->note_bounces(impl.patches);
  impl.patches.begin_tally(impulses.wanted());
  core::Progress::mark();
  impl.take_in_joints(joints);
  impl.joints.build(impl.held.size(), impl.inertias, impl.team);
  impl.team.side_by_side([&impl](const soft::Worker& worker) { impl.run(worker); });
  impl.joints.finish(impl.team);
  impl.patches.remember(impl.team);
  core::Progress::mark();
  if (impulses.wanted()) impl.tell(impulses);
  impl.team.for_each(impl.held.size() - 1, [&impl](std::size_t i) { impl.show(i + 1); });
}

}  // namespace aurasim::physics
