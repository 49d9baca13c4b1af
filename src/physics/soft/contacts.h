// The narrow phase of the soft step, in one walk over the pairs of near bodies: what touches, in patches.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include "physics/contact_cache.h"
#include "physics/soft/lanes.h"

class btCollisionDispatcher;
class btCollisionObject;

namespace aurasim::physics {

struct SoftMeeting;

/// Contact points of two bodies with one normal, at the start of a step.
struct SoftPatch {
  struct Point {
    soft::Real r_a[3] = {}, r_b[3] = {};  ///< from the centres of mass, m
    soft::Real gap = 0;                   ///< m; negative: overlap
    soft::Real impulse = 0;               ///< of the last substep, N s
  };

  btPersistentManifold* manifold = nullptr;
  bool ahead = false;                                  ///< of time: the manifold, if any, has not got the points
  int a = 0, b = 0;                                    ///< user indices: statics' are negative
  std::array<std::int8_t, soft::kMostPoints> of = {};  ///< the points in the manifold
  std::int8_t count = 0, colour = 0;
  soft::Real normal[3] = {};  ///< from a to b
  soft::Real friction = 0, restitution = 0, spinning_m = 0, rolling_m = 0;
  soft::Real rub_1 = 0, rub_2 = 0, twist = 0;  ///< impulses of friction of the last substep, N s and N m s
  std::array<Point, soft::kMostPoints> points;
};

/// A manifold with a point, or with a contact ahead of time.
struct SoftTouch {
  btPersistentManifold* manifold = nullptr;  ///< ahead of time: may be null
  int a = 0, b = 0;                          ///< user indices
  Parts parts;
  bool acts = true;  ///< on the bodies; else they go through each other
  std::uint32_t first_patch = 0, patches = 0;
};

class SoftContacts {
 public:
  /// `ahead`: what will touch within the step has a contact, too.
  SoftContacts(double step_s, bool ahead) : step_s_(static_cast<btScalar>(step_s)), looks_ahead_(ahead) {}

  /// Tells the contacts of all pairs of which one is awake.
  void look(btOverlappingPairCache& pairs, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info,
            const btVector3& gravity);

  /// In a step, if nothing is in the way, m.
  btVector3 way(const btCollisionObject& object, const btVector3& gravity) const;

  /// In no order; those of sleepers, which have no patches yet, too.
  std::span<const SoftTouch> touches() const { return touches_; }
  std::vector<SoftPatch>& patches() { return patches_; }

  /// Makes the patches of a touch. `shift`: so far has body0 been moved towards body1 to find it.
  void read(SoftTouch& touch, const btVector3& shift = {0, 0, 0});

 private:
  void look(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);
  void collect(const btBroadphasePair& pair, bool awake);
  void look_ahead(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);
  void collect_ahead(const btBroadphasePair& pair, const SoftMeeting& meeting, const btVector3& shift);
  /// Valid until the next call.
  btManifoldArray& manifolds_of(const btBroadphasePair& pair);

  btScalar step_s_;
  bool looks_ahead_;
  btVector3 gravity_{0, 0, 0};
  btManifoldArray manifolds_;
  std::vector<SoftTouch> touches_;
  std::vector<SoftPatch> patches_;
};

}  // namespace aurasim::physics
