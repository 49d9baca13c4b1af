// The narrow phase of the soft step: finds touching bodies, as patches of contact points, in one walk over the pairs of
// near bodies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "physics/soft/ahead.h"
#include "physics/soft/near_bounds.h"
#include "physics/soft/threads.h"
#include "physics/soft/touch.h"

class btCollisionDispatcher;

namespace aurasim::physics {

class FirstContacts;
class SoftIslands;
struct PairNote;

/// Two bodies with contacts ahead of time.
struct SoftAhead {
  btBroadphaseProxy *proxy_a = nullptr, *proxy_b = nullptr;
  std::uint32_t first_patch = 0, patches = 0;  ///< SoftContacts::patches_of()
  btVector3 p{0, 0, 0};                        ///< where the bodies will touch, m
  btVector3 v{0, 0, 0};  ///< velocity of the first relative to the second at the start of the step, m/s
};

class SoftContacts {
 public:
  /// `ahead`: also makes contacts of bodies that will touch within the step.
  SoftContacts(double step_s, bool ahead, soft::Team& team, const SoftIslands& islands,
               const FirstContacts& first_contacts)
      : step_s_(static_cast<btScalar>(step_s)),
        looks_ahead_(ahead),
        team_(team),
        islands_(islands),
        first_contacts_(first_contacts),
        pieces_(team.size()),
        lists_(static_cast<std::size_t>(team.size())) {}

  /// Bounds of the bodies that are awake in the next look(). Those of others need not be known.
  NearBounds& bounds() { return bounds_; }

  /// Finds the contacts of all pairs with an awake body. Pairs of sleepers are skipped if their islands are known.
  void look(btOverlappingPairCache& pairs, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info,
            const btVector3& gravity);
  /// Adds the touches among bodies that have been woken since look().
  void add_woken(btOverlappingPairCache& pairs);

  /// Adds the touches of sleepers with guests that have been woken since look().
  void add_woken_guests(btOverlappingPairCache& pairs);

  /// Way of an object in a step if it touches nothing, m.
  btVector3 way(const btCollisionObject& object, const btVector3& gravity) const;

  /// Touches with an awake body, in no order.
  std::span<const SoftTouch> touches() const { return touches_; }
  /// Touches of two sleepers, if their islands are not known.
  std::span<const SleepersTouch> touches_of_sleepers() const { return touches_of_sleepers_; }
  /// Slots of sleepers that touched a body in the last step that is awake, and do not touch it any more.
  std::span<const std::uint32_t> parted() const { return parted_; }
  std::span<SoftPatch> patches_of(const SoftTouch& touch) {
    return std::span(lists_[touch.list].patches).subspan(touch.first_patch, touch.patches);
  }
  /// Manifolds that FirstContacts has to report.
  std::span<btPersistentManifold* const> came() const { return came_; }
  /// Contacts ahead of time of two bodies, neither of them static.
  std::span<const SoftAhead> ahead() const { return ahead_; }
  std::span<const SoftPatch> patches_of(const SoftAhead& ahead) const {
    return std::span(lists_[0].patches).subspan(ahead.first_patch, ahead.patches);
  }

 private:
  struct WillMeet {
    btBroadphasePair* pair;
    SoftMeeting meeting;
  };
  /// Results of one thread.
  struct alignas(64) List {
    btManifoldArray manifolds;
    std::vector<btBroadphasePair*> wanted;  ///< pairs about which something has to be done
    std::vector<SoftTouch> touches;
    std::vector<SleepersTouch> touches_of_sleepers;
    std::vector<btPersistentManifold*> came;  ///< new ones of two bodies that move
    std::vector<std::uint32_t> parted;
    std::vector<SoftPatch> patches;
    std::vector<WillMeet> will_meet;
  };

  void look(List& list, btOverlappingPairCache& pairs, int first, int last, btCollisionDispatcher& dispatcher,
            const btDispatcherInfo& info);
  bool both_sleep(const PairNote& of) const;
  bool is_forgotten(const PairNote& of) const;
  void look(List& list, btOverlappingPairCache& pairs, btBroadphasePair& pair, btCollisionDispatcher& dispatcher,
            const btDispatcherInfo& info);
  void look(List& list, btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);
  template <class Wanted>
  void add_touches_of_sleepers(btOverlappingPairCache& pairs, Wanted&& wanted);
  void collect(List& list, const btBroadphasePair& pair);
  void gather(const soft::Worker& worker);
  void know_touches(List& list, const btBroadphasePair& pair) const;
  void look_ahead(List& list, btBroadphasePair& pair);
  void meet(const WillMeet& two, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);
  void collect_ahead(const btBroadphasePair& pair, const SoftMeeting& meeting, const btVector3& shift,
                     bool has_left_out);
  /// Reads the patches of a touch. `shift`: how far body0 was moved towards body1 to find the touch.
  void read(List& list, SoftTouch& touch, const btVector3& shift);

  NearBounds bounds_;
  btScalar step_s_;
  bool looks_ahead_;
  soft::Team& team_;
  btVector3 gravity_{0, 0, 0};
  const SoftIslands& islands_;
  const FirstContacts& first_contacts_;
  soft::Pieces pieces_;  ///< of the list of pairs
  std::vector<List> lists_;
  std::vector<SoftTouch> touches_;
  std::vector<SleepersTouch> touches_of_sleepers_;
  std::vector<std::uint32_t> parted_;
  std::vector<SoftAhead> ahead_;
  std::vector<btPersistentManifold*> came_;
};

}  // namespace aurasim::physics
