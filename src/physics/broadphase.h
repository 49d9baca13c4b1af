// Finds pairs of objects that are near each other, with trees of boxes: one of statics, and one for each column of the
// world with what moves there. A box in a tree is larger than the bounds of its object, so most objects that move
// slowly stay in theirs.
//
// Only objects that have left their boxes since the last look are looked at, by all threads. The order of pairs, and
// pairs that are near no more, depend on the past. Nothing that is computed may depend on them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include "core/used_room.h"
#include "physics/bounds.h"
#include "physics/contact_pairs.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {

/// Holds statics, of which not all are in the broadphase.
class BringsStatics {
 public:
  virtual ~BringsStatics() = default;
  /// Inserts the statics near `places` that are not in the broadphase.
  virtual void bring(std::span<const Bounds> places) = 0;
};

class Broadphase final : public btBroadphaseInterface {
 public:
  /// Both have to outlive the broadphase.
  Broadphase(ContactPairs& pairs, soft::Team& team);
  ~Broadphase() override;
  Broadphase(const Broadphase&) = delete;
  Broadphase& operator=(const Broadphase&) = delete;

  /// Calls `statics` for the boxes in which pairs are looked for, and for the ways of rays. Null: all statics are here.
  void use(BringsStatics* statics) { statics_ = statics; }
  /// True if a body's box meets `where`.
  bool has_body_near(const Bounds& where) const;

  /// The next object gets this unique id, by which the two objects of a pair are ordered.
  void number_next(int id) { next_id_ = id; }

  /// Sets the bounds of an object. Workers may call it for different objects. Call give_boxes() after that.
  void bound(btBroadphaseProxy& proxy, const Bounds& bounds, const soft::Worker& worker);
  /// Gives new boxes to the objects that have left theirs in bound().
  void give_boxes();

  btBroadphaseProxy* createProxy(const btVector3& low, const btVector3& high, int shape, void* object, int group,
                                 int mask, btDispatcher* dispatcher) override;
  void destroyProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override;
  void setAabb(btBroadphaseProxy* proxy, const btVector3& low, const btVector3& high,
               btDispatcher* dispatcher) override;
  void getAabb(btBroadphaseProxy* proxy, btVector3& low, btVector3& high) const override;
  void rayTest(const btVector3& from, const btVector3& to, btBroadphaseRayCallback& callback, const btVector3& low,
               const btVector3& high) override;
  void aabbTest(const btVector3& low, const btVector3& high, btBroadphaseAabbCallback& callback) override;
  /// Adds the pairs of objects that have left their boxes, and removes some of those that are no more.
  void calculateOverlappingPairs(btDispatcher* dispatcher) override;
  btOverlappingPairCache* getOverlappingPairCache() override { return &pairs_; }
  const btOverlappingPairCache* getOverlappingPairCache() const override { return &pairs_; }
  void getBroadphaseAabb(btVector3& low, btVector3& high) const override;
  void printStats() override {}

 private:
  struct Proxy;
  struct Near {
    Proxy *one, *other;
  };
  struct NewBox {
    Proxy* proxy;
    btDbvtVolume volume;
    std::size_t from, to;  ///< columns
  };
  /// Results of one thread.
  struct alignas(64) List {
    std::vector<const btDbvtNode*> stack;
    std::vector<Near> found;
    std::vector<NewBox> left;  ///< of objects that have left their boxes
  };

  static Proxy& of(btBroadphaseProxy& proxy);
  static const Proxy& of(const btBroadphaseProxy& proxy);
  btDbvt& tree_of(const Proxy& proxy);
  template <class Visit>
  void for_each_tree(Visit&& visit) const;
  static bool keep_in_box(Proxy& proxy, const Bounds& bounds);
  static NewBox leave_box(Proxy& proxy, const Bounds& bounds);
  void take_out(NewBox& box);
  void put_in(const NewBox& box);
  void share_columns_out(std::size_t count);
  void note_moved(Proxy& proxy);
  void bring_statics();
  void bring_statics_on_way(const btVector3& from, const btVector3& to, const Bounds& around);
  void look(List& list, Proxy& proxy);
  void look_in(const btDbvt& tree, List& list, Proxy& proxy);
  std::size_t add_found();
  void clean(std::size_t count, btDispatcher* dispatcher);

  ContactPairs& pairs_;
  soft::Team& team_;
  int next_id_ = 0;
  std::vector<btDbvt> moving_;  ///< by column
  btDbvt standing_;
  std::vector<int> thread_of_column_;  ///< in give_boxes()
  std::size_t next_to_improve_ = 0;    ///< index in moving_
  std::vector<Proxy*> moved_;          ///< objects that have left their boxes; null: removed since
  soft::Pieces pieces_;                ///< of moved_
  std::vector<List> lists_;
  BringsStatics* statics_ = nullptr;
  std::vector<Bounds> looked_in_;     ///< boxes in which pairs are about to be looked for
  core::UsedRoom used_room_;          ///< of moved_, looked_in_ and lists_
  std::size_t next_to_clean_ = 0;     ///< index of a pair
  std::size_t statics_to_place_ = 0;  ///< leaves of standing_ that may have a better place in the tree
};

}  // namespace aurasim::physics
