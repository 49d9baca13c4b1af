// Bullet's narrow phase without memory of the past: the contacts of a pair depend only on the two bodies and their
// contact cache, not on how long the pair has been known to this world.
#pragma once

#include <array>
#include <mutex>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include "physics/block_pool.h"
#include "physics/cylinder_contacts.h"
#include "physics/hull_contacts.h"
#include "physics/primitive_contacts.h"

namespace aurasim::physics {

class InnerEdges;

/// Largest gap of a contact, metres. It is the same for bodies of all sizes (Bullet's own grows with the shape),
/// because auras rely on it.
inline constexpr double kContactMargin = 0.02;

/// Several threads may compute the contacts of different pairs at the same time.
class Dispatcher : public btCollisionDispatcher {
 public:
  /// `inner_edges` have to outlive the dispatcher.
  Dispatcher(btCollisionConfiguration& configuration, const InnerEdges& inner_edges);

  const InnerEdges& inner_edges() const { return inner_edges_; }

  /// Computes the contacts of a pair. Drops them if the bodies' bounds do not overlap in this substep: the broadphase
  /// keeps pairs that were near once, for times that differ from world to world. Returns true if points with inner
  /// edges were left out (inner_edges.h).
  bool find_contacts(btBroadphasePair& pair, const btDispatcherInfo& info);
  /// Like find_contacts(), of a pair whose bounds overlap, whose bodies may touch, and of which one is awake.
  bool find_contacts_of_overlapping(btBroadphasePair& pair, const btDispatcherInfo& info);

  btPersistentManifold* getNewManifold(const btCollisionObject* body0, const btCollisionObject* body1) override;
  void releaseManifold(btPersistentManifold* manifold) override;
  void* allocateCollisionAlgorithm(int bytes) override;
  void freeCollisionAlgorithm(void* memory) override;

  /// While this is set, all pairs get a manifold, also if they do not touch.
  void make_all_manifolds(bool wanted) {
    hull_contacts_.make_all_manifolds(wanted);
    cylinder_contacts_.make_all_manifolds(wanted);
    primitive_contacts_.make_all_manifolds(wanted);
  }

 private:
  std::unique_lock<std::mutex> hold_pools();

  const InnerEdges& inner_edges_;
  HullContactsMaker hull_contacts_;
  CylinderContactsMaker cylinder_contacts_;
  PrimitiveContactsMaker primitive_contacts_{kContactMargin};
  // Memory that grows with the contacts: Bullet's own pools take 6 MB in a world without any.
  BlockPool manifolds_{sizeof(btPersistentManifold)};
  std::array<BlockPool, 4> algorithms_{BlockPool(64), BlockPool(128), BlockPool(256), BlockPool(1024)};
  std::mutex pools_mutex_;
};

}  // namespace aurasim::physics
