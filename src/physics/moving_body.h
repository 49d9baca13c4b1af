// A rigid body that is not static. It knows its block and its size.
#pragma once

#include <cstdint>
#include <vector>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/block.h"

namespace aurasim::physics {

/// The user pointer of a MovingBody points to one.
struct BodyPlace {
  core::Block block{0, 0};
  double radius_m = 0;    ///< of a ball around the centre of mass that holds the shape
  bool is_bound = false;  ///< its block is that of another body, which is the first of its mechanism
  std::vector<std::uint32_t>* changes = nullptr;  ///< of SoftIslands, while the body is in its world
  core::BodyId id{};
  // Where regions are coupled (physics/coupling.h):
  bool is_guest = false;  ///< another region hosts it
  core::RegionId host{};  ///< of a guest
  std::uint64_t met = 0;  ///< of a guest: the last meeting that it came to
};

class MovingBody final : public btRigidBody {
 public:
  explicit MovingBody(const btRigidBodyConstructionInfo& info) : btRigidBody(info) {
    btVector3 centre;
    btScalar radius_m = 0;
    getCollisionShape()->getBoundingSphere(centre, radius_m);
    place_.radius_m = static_cast<double>(centre.length() + radius_m);
    setUserPointer(&place_);
  }
  MovingBody(const MovingBody&) = delete;
  MovingBody& operator=(const MovingBody&) = delete;

 private:
  BodyPlace place_;
};

/// Precondition: `body` is a MovingBody.
inline BodyPlace& place_of(btRigidBody& body) { return *static_cast<BodyPlace*>(body.getUserPointer()); }
inline const BodyPlace& place_of(const btRigidBody& body) { return *static_cast<BodyPlace*>(body.getUserPointer()); }

/// Moves a body. Leaves out Bullet's pose for interpolation, which nothing here reads.
inline void move_to(btRigidBody& body, const btTransform& X_WB) {
  body.setWorldTransform(X_WB);
  body.updateInertiaTensor();
}

/// Call after the activation state or the block of a body has been changed outside of a step.
inline void note_change(const btRigidBody& body) {
  const auto* const place = static_cast<const BodyPlace*>(body.getUserPointer());
  if (place == nullptr || place->changes == nullptr) return;
  place->changes->push_back(static_cast<std::uint32_t>(body.getUserIndex3()));
}
/// False for statics.
inline bool is_guest(const btRigidBody& body) { return !body.isStaticObject() && place_of(body).is_guest; }

}  // namespace aurasim::physics
