#include "physics/soft/islands.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/prefetch.h"
#include "physics/soft/mover.h"

namespace aurasim::physics {
namespace {

bool is_asleep(const btCollisionObject& object) { return object.getActivationState() == ISLAND_SLEEPING; }

bool needs_response(const btCollisionObject& a, const btCollisionObject& b) {
  return a.hasContactResponse() && b.hasContactResponse();
}

}  // namespace

/// The path behind it is halved.
std::uint32_t SoftIslands::island_of(std::uint32_t body) {
  while (parents_[body] != body) body = parents_[body] = parents_[parents_[body]];
  return body;
}

void SoftIslands::unite(int a, int b) {
  const std::uint32_t one = island_of(static_cast<std::uint32_t>(a)), other = island_of(static_cast<std::uint32_t>(b));
  parents_[std::max(one, other)] = std::min(one, other);
}

void SoftIslands::find(std::span<btRigidBody* const> bodies, std::span<btPersistentManifold* const> manifolds,
                       std::span<btTypedConstraint* const> joints) {
  int last = -1;
  for (const btRigidBody* body : bodies) last = std::max(last, body->getUserIndex());
  parents_.resize(static_cast<std::size_t>(last + 1));
  std::iota(parents_.begin(), parents_.end(), 0U);

  contacts_.clear();
  for_each_touching(manifolds, [this](btPersistentManifold& manifold) {
    const btCollisionObject& body0 = *manifold.getBody0();
    const btCollisionObject& body1 = *manifold.getBody1();
    const auto [first, last] = std::minmax({body0.getUserIndex(), body1.getUserIndex()});
    if (first >= 0 && body0.mergesSimulationIslands() && body1.mergesSimulationIslands()) unite(first, last);
    if (needs_response(body0, body1)) contacts_.push_back({static_cast<std::uint32_t>(last), first, &manifold});
  });
  for (const btTypedConstraint* joint : joints) {
    const btRigidBody& a = joint->getRigidBodyA();
    const btRigidBody& b = joint->getRigidBodyB();
    if (joint->isEnabled() && !a.isStaticObject() && !b.isStaticObject()) unite(a.getUserIndex(), b.getUserIndex());
  }

  settle(bodies);
  sort();
  joints_.clear();
  for (btTypedConstraint* joint : joints) {
    const bool moves = joint->getRigidBodyA().isActive() || joint->getRigidBodyB().isActive();
    if (joint->isEnabled() && moves) joints_.push_back(joint);
  }
  std::ranges::sort(joints_, {}, &btTypedConstraint::getUserConstraintId);
}

/// As Bullet does: an island sleeps when nobody in it is active; one active body keeps all others from sleeping.
void SoftIslands::settle(std::span<btRigidBody* const> bodies) {
  states_.assign(parents_.size(), 0);
  const auto island = [this](const btRigidBody& body) {
    return island_of(static_cast<std::uint32_t>(body.getUserIndex()));
  };
  for (const btRigidBody* body : bodies) {
    const int state = body->getActivationState();
    if (state == ACTIVE_TAG || state == DISABLE_DEACTIVATION) states_[island(*body)] = 1;
  }
  awake_.clear();
  for (btRigidBody* body : bodies) {
    if (states_[island(*body)] == 0) {
      body->setActivationState(ISLAND_SLEEPING);
    } else if (is_asleep(*body)) {
      body->setActivationState(WANTS_DEACTIVATION);
      body->setDeactivationTime(0);
    }
    if (body->isActive()) {
      awake_.push_back(body);
    } else {
      set_mover(*body, 0);
    }
  }
}

/// By counting: they come in no order, and there are several for each body. Parts matter for compounds only.
void SoftIslands::sort() {
  ends_.assign(parents_.size() + 1, 0);
  std::erase_if(contacts_, [](const Contact& contact) {
    return is_asleep(*contact.manifold->getBody0()) && is_asleep(*contact.manifold->getBody1());
  });
  for (const Contact& contact : contacts_) ++ends_[contact.last + 1];
  for (std::size_t i = 1; i < ends_.size(); ++i) ends_[i] += ends_[i - 1];
  sorted_.resize(contacts_.size());
  for (const Contact& contact : contacts_) sorted_[ends_[contact.last]++] = contact;

  const auto before = [](const Contact& a, const Contact& b) {
    if (a.first != b.first) return a.first < b.first;
    const auto rest = [](const btPersistentManifold& manifold) {
      return std::tuple(manifold.getBody0()->getUserIndex(), parts_of(manifold));
    };
    return rest(*a.manifold) < rest(*b.manifold);
  };
  std::size_t first = 0;
  for (std::size_t body = 0; body + 1 < ends_.size(); ++body) {  // each has by now grown to the end of its contacts
    std::sort(sorted_.begin() + static_cast<std::ptrdiff_t>(first),
              sorted_.begin() + static_cast<std::ptrdiff_t>(ends_[body]), before);
    first = ends_[body];
  }
  manifolds_.clear();
  for (const Contact& contact : sorted_) manifolds_.push_back(contact.manifold);
}

}  // namespace aurasim::physics
