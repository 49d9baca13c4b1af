#include "physics/soft/islands.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace aurasim::physics {
namespace {

bool sleeps(const btCollisionObject& object) { return object.getActivationState() == ISLAND_SLEEPING; }

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

void SoftIslands::find(std::span<btRigidBody* const> bodies, std::span<const SoftTouch> touches,
                       std::span<btTypedConstraint* const> joints) {
  int last = -1;
  for (const btRigidBody* body : bodies) last = std::max(last, body->getUserIndex());
  parents_.resize(static_cast<std::size_t>(last + 1));
  std::iota(parents_.begin(), parents_.end(), 0U);

  for (const SoftTouch& touch : touches) {
    if (touch.a >= 0 && touch.b >= 0) unite(touch.a, touch.b);
  }
  for (const btTypedConstraint* joint : joints) {
    const btRigidBody& a = joint->getRigidBodyA();
    const btRigidBody& b = joint->getRigidBodyB();
    if (joint->isEnabled() && !a.isStaticObject() && !b.isStaticObject()) unite(a.getUserIndex(), b.getUserIndex());
  }

  settle(bodies);
  sort(touches);
  joints_.clear();
  for (btTypedConstraint* joint : joints) {
    const bool moves = joint->getRigidBodyA().isActive() || joint->getRigidBodyB().isActive();
    if (joint->isEnabled() && moves) joints_.push_back(joint);
  }
  std::ranges::sort(joints_, {}, &btTypedConstraint::getUserConstraintType);
}

/// As Bullet does: an island sleeps when nobody in it is active; one active body keeps all others from sleeping.
void SoftIslands::settle(std::span<btRigidBody* const> bodies) {
  states_.assign(parents_.size(), 0);
  is_awake_.assign(parents_.size(), 0);
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
    } else if (sleeps(*body)) {
      body->setActivationState(WANTS_DEACTIVATION);
      body->setDeactivationTime(0);
    }
    if (!body->isActive()) continue;
    awake_.push_back(body);
    is_awake_[static_cast<std::size_t>(body->getUserIndex())] = 1;
  }
}

/// By counting: they come in no order, and there are several for each body. Parts matter for compounds only.
void SoftIslands::sort(std::span<const SoftTouch> touches) {
  const auto first_of = [](const SoftTouch& touch) { return std::min(touch.a, touch.b); };
  const auto last_of = [](const SoftTouch& touch) { return static_cast<std::size_t>(std::max(touch.a, touch.b)); };
  const auto counts = [&](const SoftTouch& touch) {
    const int first = first_of(touch);
    const bool awake =
        is_awake_[last_of(touch)] != 0 || (first >= 0 && is_awake_[static_cast<std::size_t>(first)] != 0);
    return touch.acts && awake;
  };
  ends_.assign(parents_.size() + 1, 0);
  for (const SoftTouch& touch : touches) {
    if (counts(touch)) ++ends_[last_of(touch) + 1];
  }
  for (std::size_t i = 1; i < ends_.size(); ++i) ends_[i] += ends_[i - 1];
  touches_.resize(ends_.back());
  for (const SoftTouch& touch : touches) {
    if (counts(touch)) touches_[ends_[last_of(touch)]++] = touch;
  }

  const auto before = [first_of](const SoftTouch& x, const SoftTouch& y) {
    if (first_of(x) != first_of(y)) return first_of(x) < first_of(y);
    return std::tie(x.a, x.parts) < std::tie(y.a, y.parts);
  };
  std::size_t first = 0;
  for (std::size_t body = 0; body + 1 < ends_.size(); ++body) {  // each has by now grown to the end of its touches
    std::sort(touches_.begin() + static_cast<std::ptrdiff_t>(first),
              touches_.begin() + static_cast<std::ptrdiff_t>(ends_[body]), before);
    first = ends_[body];
  }
}

}  // namespace aurasim::physics
