// Bullet's narrow phase with its memory of the past taken out: what a pair does depends on the two bodies and on their
// contact cache only, not on how long the pair has been known to this world.
#pragma once

#include <mutex>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace aurasim::physics {

/// Contacts begin and end at this gap at the latest, however large the bodies (Bullet's grow with the shape). The
/// auras count on it. Metres.
inline constexpr double kContactMargin = 0.02;

/// Several threads may tell the contacts of different pairs at the same time.
class Dispatcher : public btCollisionDispatcher {
 public:
  explicit Dispatcher(btCollisionConfiguration& configuration);

  btPersistentManifold* getNewManifold(const btCollisionObject* body0, const btCollisionObject* body1) override;
  void releaseManifold(btPersistentManifold* manifold) override;
  void* allocateCollisionAlgorithm(int bytes) override;
  void freeCollisionAlgorithm(void* memory) override;

 private:
  std::mutex pools_;
};

}  // namespace aurasim::physics
