// Bullet's narrow phase without memory of the past: the contacts of a pair depend only on the two bodies and their
// contact cache, not on how long the pair has been known to this world.
#pragma once

#include <mutex>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include "physics/hull_contacts.h"

namespace aurasim::physics {

/// Largest gap of a contact, metres. It is the same for bodies of all sizes (Bullet's own grows with the shape),
/// because auras rely on it.
inline constexpr double kContactMargin = 0.02;

/// Several threads may compute the contacts of different pairs at the same time.
class Dispatcher : public btCollisionDispatcher {
 public:
  explicit Dispatcher(btCollisionConfiguration& configuration);

  btPersistentManifold* getNewManifold(const btCollisionObject* body0, const btCollisionObject* body1) override;
  void releaseManifold(btPersistentManifold* manifold) override;
  void* allocateCollisionAlgorithm(int bytes) override;
  void freeCollisionAlgorithm(void* memory) override;

  /// While this is set, hulls and boxes get a manifold also if they do not touch.
  void make_all_manifolds(bool wanted) { hull_contacts_.make_all_manifolds(wanted); }

 private:
  HullContactsMaker hull_contacts_;
  std::mutex pools_;
};

}  // namespace aurasim::physics
