#include "physics/contact_islands.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletDynamics/ConstraintSolver/btConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include "physics/prefetch.h"

namespace aurasim::physics {
namespace {

bool is_asleep(const btCollisionObject& object) { return object.getActivationState() == ISLAND_SLEEPING; }

/// Packs two user indices into one number, which sorts like (index0, index1). Indices of statics are negative.
std::uint64_t both_indices(const btPersistentManifold& manifold) {
  const auto shifted = [](const btCollisionObject* object) {
    return static_cast<std::uint32_t>(std::int64_t{object->getUserIndex()} - std::numeric_limits<std::int32_t>::min());
  };
  return std::uint64_t{shifted(manifold.getBody0())} << 32 | shifted(manifold.getBody1());
}

int island_of(const btPersistentManifold& manifold) {
  return std::max(manifold.getBody0()->getIslandTag(), manifold.getBody1()->getIslandTag());  // statics: -1
}

}  // namespace

void ContactIslands::updateActivationState(btCollisionWorld* world, btDispatcher* dispatcher) {
  int moving = 0;
  btCollisionObjectArray& objects = world->getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    if (!objects[i]->isStaticOrKinematicObject()) objects[i]->setIslandTag(moving++);
  }
  initUnionFind(moving);
  for_each_touching(manifolds_of(*dispatcher), [this](const btPersistentManifold& manifold) {
    const btCollisionObject* const body0 = manifold.getBody0();
    const btCollisionObject* const body1 = manifold.getBody1();
    if (body0->mergesSimulationIslands() && body1->mergesSimulationIslands()) {
      getUnionFind().unite(body0->getIslandTag(), body1->getIslandTag());
    }
  });
}

/// Puts an island to sleep or wakes it, as Bullet does. It sleeps when no body in it is active; one active body keeps
/// all others awake.
void ContactIslands::settle(btCollisionWorld& world, int first, int last) {
  btCollisionObjectArray& objects = world.getCollisionObjectArray();
  const auto body = [&](int element) -> btCollisionObject& {
    return *objects[getUnionFind().getElement(element).m_sz];
  };
  bool sleeps = true;
  for (int i = first; i < last && sleeps; ++i) {
    const int state = body(i).getActivationState();
    sleeps = state != ACTIVE_TAG && state != DISABLE_DEACTIVATION;
  }
  for (int i = first; i < last; ++i) {
    if (sleeps) {
      body(i).setActivationState(ISLAND_SLEEPING);
    } else if (is_asleep(body(i))) {
      body(i).setActivationState(WANTS_DEACTIVATION);
      body(i).setDeactivationTime(0);
    }
  }
}

void ContactIslands::collect_awake_manifolds(btDispatcher& dispatcher) {
  entries_.clear();
  for_each_touching(manifolds_of(dispatcher), [&](btPersistentManifold& manifold) {
    const btCollisionObject* const body0 = manifold.getBody0();
    const btCollisionObject* const body1 = manifold.getBody1();
    if (is_asleep(*body0) && is_asleep(*body1)) return;
    if (!dispatcher.needsResponse(body0, body1)) return;
    entries_.push_back({island_of(manifold), both_indices(manifold), parts_of(manifold), &manifold});
  });
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.island, a.bodies, a.parts) < std::tie(b.island, b.bodies, b.parts);
  });
  manifolds_.clear();
  for (const Entry& entry : entries_) manifolds_.push_back(entry.manifold);
}

void ContactIslands::collect_awake_joints(std::span<btTypedConstraint* const> joints) {
  joint_entries_.clear();
  for (btTypedConstraint* joint : joints) {
    const btRigidBody& a = joint->getRigidBodyA();
    const btRigidBody& b = joint->getRigidBodyB();
    if (!joint->isEnabled() || !(a.isActive() || b.isActive())) continue;
    joint_entries_.push_back({std::max(a.getIslandTag(), b.getIslandTag()), joint->getUserConstraintType(), joint});
  }
  std::sort(joint_entries_.begin(), joint_entries_.end(), [](const JointEntry& a, const JointEntry& b) {
    return std::tie(a.island, a.order) < std::tie(b.island, b.order);
  });
  joints_.clear();
  for (const JointEntry& entry : joint_entries_) joints_.push_back(entry.joint);
}

int ContactIslands::end_of_island(int first) {
  int last = first + 1;
  while (last < getUnionFind().getNumElements() &&
         getUnionFind().getElement(last).m_id == getUnionFind().getElement(first).m_id) {
    ++last;
  }
  return last;
}

template <class Visit>
void ContactIslands::for_each_awake(btCollisionWorld& world, std::span<btTypedConstraint* const> joints,
                                    Visit&& visit) {
  getUnionFind().sortIslands();
  const int elements = getUnionFind().getNumElements();
  for (int first = 0, last = 0; first < elements; first = last) {
    last = end_of_island(first);
    settle(world, first, last);
  }
  collect_awake_manifolds(*world.getDispatcher());
  collect_awake_joints(joints);

  std::size_t manifold = 0;
  std::size_t joint = 0;
  for (int first = 0, last = 0; first < elements; first = last) {
    last = end_of_island(first);
    const std::size_t first_manifold = manifold;
    const std::size_t first_joint = joint;
    const int island = getUnionFind().getElement(first).m_id;
    while (manifold < entries_.size() && entries_[manifold].island == island) ++manifold;
    while (joint < joint_entries_.size() && joint_entries_[joint].island == island) ++joint;
    island_.clear();
    bool awake = false;
    for (int i = first; i < last; ++i) {
      island_.push_back(world.getCollisionObjectArray()[getUnionFind().getElement(i).m_sz]);
      awake = awake || island_.back()->isActive();
    }
    if (!awake) continue;
    visit(std::span(island_), std::span(manifolds_).subspan(first_manifold, manifold - first_manifold),
          std::span(joints_).subspan(first_joint, joint - first_joint));
  }
}

void ContactIslands::solve(btCollisionWorld& world, std::span<btTypedConstraint* const> joints,
                           btConstraintSolver& solver, const btContactSolverInfo& info) {
  const auto solve_group = [&](std::span<btCollisionObject*> bodies, std::span<btPersistentManifold*> manifolds,
                               std::span<btTypedConstraint*> constraints) {
    if (bodies.empty()) return;
    solver.solveGroup(bodies.data(), static_cast<int>(bodies.size()), manifolds.data(),
                      static_cast<int>(manifolds.size()), constraints.data(), static_cast<int>(constraints.size()),
                      info, nullptr, world.getDispatcher());
  };
  lonely_.clear();
  for_each_awake(world, joints, [&](auto bodies, auto manifolds, auto constraints) {
    if (manifolds.empty() && constraints.empty()) {
      lonely_.insert(lonely_.end(), bodies.begin(), bodies.end());
    } else {
      solve_group(bodies, manifolds, constraints);
    }
  });
  solve_group(lonely_, {}, {});
}

}  // namespace aurasim::physics
