// The narrow phase of the soft step, in one walk over the pairs of near bodies: what touches, in patches.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include "physics/contact_cache.h"
#include "physics/soft/ahead.h"
#include "physics/soft/lanes.h"

class btCollisionDispatcher;
class btCollisionObject;

namespace aurasim::physics {

/// Contact points of two bodies with one normal, at the start of a step.
struct SoftPatch {
  struct Point {
    soft::Real r_a[3] = {}, r_b[3] = {};  ///< from the centres of mass, m
    soft::Real gap = 0;                   ///< m; negative: overlap
    soft::Real impulse = 0;               ///< of the last substep, N s
  };

  btPersistentManifold* manifold = nullptr;
  bool ahead = false;                                  ///< of time: the manifold, if any, has not got the points
  bool has_pressed = false;                            ///< ahead of time: the two have touched in the step
  int a = 0, b = 0;                                    ///< user indices: statics' are negative
  std::array<std::int8_t, soft::kMostPoints> of = {};  ///< the points in the manifold
  std::int8_t count = 0;
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
  bool acts = true;                                      ///< on the bodies; else they go through each other
  std::uint32_t list = 0, first_patch = 0, patches = 0;  ///< SoftContacts::patches_of()
};

/// Two bodies with contacts ahead of time.
struct SoftAhead {
  const btBroadphasePair* pair = nullptr;
  std::uint32_t first_patch = 0, patches = 0;  ///< SoftContacts::patches_of()
  btVector3 p{0, 0, 0};                        ///< where they will touch, m
  btVector3 v{0, 0, 0};                        ///< of the first as seen from the second, at the start of the step, m/s
};

class SoftContacts {
 public:
  /// `ahead`: what will touch within the step has a contact, too.
  SoftContacts(double step_s, bool ahead, int threads)
      : step_s_(static_cast<btScalar>(step_s)),
        looks_ahead_(ahead),
        threads_(threads),
        lists_(static_cast<std::size_t>(threads)) {}

  /// Tells the contacts of all pairs of which one is awake.
  void look(btOverlappingPairCache& pairs, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info,
            const btVector3& gravity);

  /// In a step, if nothing is in the way, m.
  btVector3 way(const btCollisionObject& object, const btVector3& gravity) const;

  /// In no order; those of sleepers, which have no patches yet, too.
  std::span<const SoftTouch> touches() const { return touches_; }
  std::span<SoftPatch> patches_of(const SoftTouch& touch) {
    return std::span(lists_[touch.list].patches).subspan(touch.first_patch, touch.patches);
  }
  /// Of bodies that both move.
  std::span<const SoftAhead> ahead() const { return ahead_; }
  std::span<const SoftPatch> patches_of(const SoftAhead& ahead) const {
    return std::span(lists_[0].patches).subspan(ahead.first_patch, ahead.patches);
  }

  /// Makes the patches of a touch of one that has just been woken.
  void read(SoftTouch& touch) {
    touch.list = 0;
    read(lists_[0], touch, {0, 0, 0});
  }

 private:
  struct WillMeet {
    btBroadphasePair* pair;
    SoftMeeting meeting;
  };
  /// What one thread finds.
  struct alignas(64) List {
    btManifoldArray manifolds;
    std::vector<SoftTouch> touches;
    std::vector<SoftPatch> patches;
    std::vector<WillMeet> will_meet;
  };

  void look(List& list, btOverlappingPairCache& pairs, int first, int last, btCollisionDispatcher& dispatcher,
            const btDispatcherInfo& info);
  void look(List& list, btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);
  void collect(List& list, const btBroadphasePair& pair, bool awake);
  void look_ahead(List& list, btBroadphasePair& pair);
  void meet(const WillMeet& two, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);
  void collect_ahead(const btBroadphasePair& pair, const SoftMeeting& meeting, const btVector3& shift);
  /// `shift`: so far has body0 been moved towards body1 to find the touch.
  void read(List& list, SoftTouch& touch, const btVector3& shift);

  btScalar step_s_;
  bool looks_ahead_;
  int threads_;
  btVector3 gravity_{0, 0, 0};
  std::vector<List> lists_;
  std::vector<SoftTouch> touches_;
  std::vector<SoftAhead> ahead_;
};

}  // namespace aurasim::physics
