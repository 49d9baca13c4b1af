#include "physics/soft/step.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/progress.h"
#include "physics/contact_impulses.h"
#include "physics/prefetch.h"
#include "physics/settings.h"
#include "physics/soft/convert.h"
#include "physics/soft/joints.h"
#include "physics/soft/patches.h"
#include "physics/soft/shared.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {
namespace {

using soft::Real;

/// Highest speed at which overlaps are pushed apart.
constexpr Real kTopPush_m_s = 3;
/// Sweeps over joints in each substep: before contacts (several, because their impulses start from 0), and after bodies
/// have moved.
constexpr int kJointSweeps = 4, kLastJointSweeps = 2;

}  // namespace

struct SoftStep::Impl {
  Impl(const Settings& settings, soft::Team& its_team)
      : team(its_team),
        h_s(static_cast<Real>(settings.step_s / settings.substeps)),
        substeps(settings.substeps),
        movers(settings, its_team),
        patches(settings.step_s, settings.substeps),
        joints(settings.step_s / settings.substeps) {}

  void take_in_shared(std::span<const SoftTouch> touches, SoftContacts& contacts);
  void take_in_patches(std::span<const SoftTouch> touches, SoftContacts& contacts);
  void take_in_joints(std::span<btTypedConstraint* const> joint_list);
  void run(const soft::Worker& worker);
  void tell(ContactImpulses& impulses) const;

  soft::Team& team;
  Real h_s;
  int substeps;
  SoftShared* shared = nullptr;
  SoftMovers movers;
  std::vector<std::size_t> patches_before;  ///< by thread: number of patches of the threads before it
  SoftPatches patches;
  SoftJoints joints;
};

SoftStep::SoftStep(const Settings& settings, soft::Team& team) : impl_(std::make_unique<Impl>(settings, team)) {}
SoftStep::~SoftStep() = default;

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
      patches.clear(movers.size(), patches_before.back());
    }
    worker.wait();
    std::size_t next = patches_before[number];
    for (std::size_t i = first; i < last; ++i) {
      const std::int32_t a = movers.number_of(touches[i].a), b = movers.number_of(touches[i].b);
      const SoftPhase phase = movers.phase_of(a, b);
      const std::size_t group = movers.group_of(phase, a);
      for (SoftPatch& patch : contacts.patches_of(touches[i])) patches.put(next++, patch, a, b, phase, group);
    }
  });
}

/// Lists the patches, with those of chains of contacts over several regions at the end.
void SoftStep::Impl::take_in_shared(std::span<const SoftTouch> touches, SoftContacts& contacts) {
  shared->begin();
  for (const SoftTouch& touch : touches) {
    const std::int32_t a = movers.number_of(touch.a), b = movers.number_of(touch.b);
    const SoftPhase phase = movers.phase_of(a, b);
    const std::size_t group = movers.group_of(phase, a);
    shared->add(touch, contacts.patches_of(touch), a, b, phase, group);
  }
  shared->settle();
  const std::span<const SoftShared::Placed> placed = shared->placed();
  patches.clear(movers.size(), placed.size());
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
      joints.put(i, joint, movers.number_of(joint.getRigidBodyA().getUserIndex()),
                 movers.number_of(joint.getRigidBodyB().getUserIndex()));
    }
  });
}

void SoftStep::Impl::run(const soft::Worker& worker) {
  soft::Mover* const all = movers.data();
  joints.look(all, worker);
  soft::Substep substep{1 / h_s, kTopPush_m_s, true};
  for (int s = 0; s < substeps; ++s) {
    movers.push(worker);
    worker.wait();
    patches.warm_start(all, worker);
    joints.begin_and_solve(all, kJointSweeps, worker);
    substep.pushes = true;
    patches.solve(all, substep, shared, worker);
    movers.move(worker);
    worker.wait();
    joints.look_and_solve(all, kLastJointSweeps, worker);
    substep.pushes = false;
    patches.solve(all, substep, shared, worker);
    if (s + 1 < substeps) patches.tally(worker);
  }
  patches.bounce(all, shared, worker);
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
      const btVector3& centre = movers.start_of(a > 0 ? a : b);
      const btVector3 p = centre + soft::to_bullet(a > 0 ? point.r_a : point.r_b);
      impulses.add(patch.a, patch.b, p, soft::to_bullet(patch.normal), static_cast<double>(patches.tallied(i, k)));
    }
  }
}

void SoftStep::solve(const SoftBodies& bodies, SoftContacts& contacts, ContactImpulses& impulses) {
  Impl& impl = *impl_;
  impl.shared = bodies.shared;
  impl.movers.take_in(bodies);
  if (bodies.shared != nullptr) {
    impl.take_in_shared(bodies.touches, contacts);
  } else {
    impl.take_in_patches(bodies.touches, contacts);
  }
  Real pull[3];
  soft::from_bullet(bodies.gravity, pull);
  impl.patches.build(impl.movers.data(), impl.movers.inertias().data(), pull, impl.team);
  if (bodies.shared != nullptr) bodies.shared->note_bounces(impl.patches);
  impl.patches.begin_tally(impulses.wanted());
  core::Progress::mark();
  impl.take_in_joints(bodies.joints);
  impl.joints.build(impl.movers.size(), impl.movers.inertias(), impl.team);
  impl.team.side_by_side([&impl](const soft::Worker& worker) { impl.run(worker); });
  impl.joints.finish(impl.team);
  impl.patches.remember(impl.team);
  core::Progress::mark();
  if (impulses.wanted()) impl.tell(impulses);
  impl.movers.show();
}

}  // namespace aurasim::physics
