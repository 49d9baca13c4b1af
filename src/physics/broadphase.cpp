#include "physics/broadphase.h"

#include <algorithm>
#include <atomic>

#include "core/progress.h"

namespace aurasim::physics {
namespace {

/// A box is larger than the bounds by this on all sides, m.
constexpr btScalar kMargin_m = btScalar(0.05);
/// An object that moves gets a box for so many steps on, but not larger than twice its bounds.
constexpr btScalar kStepsAhead = 6;
/// In each look, one pair in so many is tested for whether it is still near, but no more than so many for each object
/// that has left its box.
constexpr std::size_t kLooksForAll = 10, kPairsOfObject = 8;
/// In each look, one static in so many is given a better place in the tree, until each has been.
constexpr std::size_t kLooksForStatics = 100;
/// For each static that comes, so many are given a better place.
constexpr std::size_t kPlacedForOne = 4;

btDbvtVolume volume_of(const btVector3& low, const btVector3& high) { return btDbvtVolume::FromMM(low, high); }

struct ForRays : btDbvt::ICollide {
  void Process(const btDbvtNode* leaf) { met.push_back(static_cast<btBroadphaseProxy*>(leaf->data)); }
  std::vector<btBroadphaseProxy*> met;
};

struct ForBoxes : btDbvt::ICollide {
  explicit ForBoxes(btBroadphaseAabbCallback& wanted) : callback(wanted) {}
  void Process(const btDbvtNode* leaf) { callback.process(static_cast<btBroadphaseProxy*>(leaf->data)); }
  btBroadphaseAabbCallback& callback;
};

}  // namespace

struct Broadphase::Proxy : btBroadphaseProxy {
  using btBroadphaseProxy::btBroadphaseProxy;

  btDbvtNode* leaf = nullptr;
  bool stands = false;  ///< it is in the tree of statics
  int moved = -1;       ///< index in moved_; -1: it is in its box
};

Broadphase::Proxy& Broadphase::of(btBroadphaseProxy& proxy) { return static_cast<Proxy&>(proxy); }
const Broadphase::Proxy& Broadphase::of(const btBroadphaseProxy& proxy) { return static_cast<const Proxy&>(proxy); }
btDbvt& Broadphase::tree_of(const Proxy& proxy) { return proxy.stands ? standing_ : moving_; }

Broadphase::Broadphase(ContactPairs& pairs, soft::Team& team)
    : pairs_(pairs), team_(team), lists_(static_cast<std::size_t>(team.size())) {}

Broadphase::~Broadphase() = default;

btBroadphaseProxy* Broadphase::createProxy(const btVector3& low, const btVector3& high, int, void* object, int group,
                                           int mask, btDispatcher*) {
  auto* const proxy = new Proxy(low, high, object, group, mask);
  proxy->m_uniqueId = next_id_++;
  proxy->stands = (group & btBroadphaseProxy::StaticFilter) != 0;
  proxy->leaf = tree_of(*proxy).insert(volume_of(low, high), proxy);
  if (proxy->stands) {
    statics_to_place_ = std::min(statics_to_place_ + kPlacedForOne, static_cast<std::size_t>(standing_.m_leaves));
  }
  note_moved(*proxy);
  return proxy;
}

void Broadphase::destroyProxy(btBroadphaseProxy* leaving, btDispatcher* dispatcher) {
  Proxy* const proxy = &of(*leaving);
  tree_of(*proxy).remove(proxy->leaf);
  if (proxy->moved >= 0) moved_[static_cast<std::size_t>(proxy->moved)] = nullptr;
  pairs_.removeOverlappingPairsContainingProxy(proxy, dispatcher);
  delete proxy;
}

void Broadphase::note_moved(Proxy& proxy) {
  if (proxy.moved >= 0) return;
  proxy.moved = static_cast<int>(moved_.size());
  moved_.push_back(&proxy);
}

bool Broadphase::keep_in_box(btBroadphaseProxy& kept, const btVector3& low, const btVector3& high) {
  Proxy& proxy = of(kept);
  if (!proxy.leaf->volume.Contain(volume_of(low, high))) return false;
  proxy.m_aabbMin = low, proxy.m_aabbMax = high;
  return true;
}

void Broadphase::setAabb(btBroadphaseProxy* moved, const btVector3& low, const btVector3& high, btDispatcher*) {
  if (keep_in_box(*moved, low, high)) return;
  Proxy& proxy = of(*moved);
  const btVector3 margin(kMargin_m, kMargin_m, kMargin_m);
  btVector3 ahead = (low - proxy.m_aabbMin) * kStepsAhead;
  const btVector3 most = (high - low) / 2;
  for (int axis = 0; axis < 3; ++axis) ahead[axis] = std::clamp(ahead[axis], -most[axis], most[axis]);
  proxy.m_aabbMin = low, proxy.m_aabbMax = high;
  btDbvtVolume box = volume_of(low - margin, high + margin);
  box.SignedExpand(ahead);
  tree_of(proxy).update(proxy.leaf, box);
  note_moved(proxy);
}

void Broadphase::getAabb(btBroadphaseProxy* proxy, btVector3& low, btVector3& high) const {
  low = proxy->m_aabbMin, high = proxy->m_aabbMax;
}

void Broadphase::rayTest(const btVector3& from, const btVector3& to, btBroadphaseRayCallback& callback,
                         const btVector3& low, const btVector3& high) {
  if (statics_ != nullptr) bring_statics_on_way(from, to, {low, high});
  ForRays each;
  btAlignedObjectArray<const btDbvtNode*> stack;
  for (const btDbvt* tree : {&moving_, &standing_}) {
    tree->rayTestInternal(tree->m_root, from, to, callback.m_rayDirectionInverse, callback.m_signs,
                          callback.m_lambda_max, low, high, stack, each);
  }
  // The first of two hits at one place counts, so their order must not depend on the trees.
  std::ranges::sort(each.met, {}, [](const btBroadphaseProxy* proxy) { return proxy->m_uniqueId; });
  for (btBroadphaseProxy* proxy : each.met) callback.process(proxy);
}

/// A long ray is cut into pieces, because the bounds of all of it may be large. `around`: of what is cast, around its
/// origin.
void Broadphase::bring_statics_on_way(const btVector3& from, const btVector3& to, const Bounds& around) {
  constexpr btScalar kPiece_m = 16;
  constexpr int kMostPieces = 1000;
  const int count =
      static_cast<int>(std::clamp(btScalar(1) + (to - from).length() / kPiece_m, btScalar(1), btScalar(kMostPieces)));
  for (int i = 0; i < count; ++i) {
    const btVector3 begin = from.lerp(to, btScalar(i) / count), end = from.lerp(to, btScalar(i + 1) / count);
    Bounds piece{begin, begin};
    piece.add({end, end});
    piece.low += around.low, piece.high += around.high;
    statics_->bring({&piece, 1});
  }
}

bool Broadphase::has_body_near(const Bounds& where) const {
  if (moving_.empty()) return false;
  const btDbvtVolume box = volume_of(where.low, where.high);
  btAlignedObjectArray<const btDbvtNode*> stack;
  stack.push_back(moving_.m_root);
  while (stack.size() > 0) {
    const btDbvtNode* const node = stack[stack.size() - 1];
    stack.pop_back();
    if (!Intersect(node->volume, box)) continue;
    if (node->isleaf()) return true;
    stack.push_back(node->childs[0]), stack.push_back(node->childs[1]);
  }
  return false;
}

void Broadphase::aabbTest(const btVector3& low, const btVector3& high, btBroadphaseAabbCallback& callback) {
  ForBoxes each(callback);
  for (const btDbvt* tree : {&moving_, &standing_}) tree->collideTV(tree->m_root, volume_of(low, high), each);
}

void Broadphase::getBroadphaseAabb(btVector3& low, btVector3& high) const {
  low = high = btVector3(0, 0, 0);
  for (const btDbvt* tree : {&moving_, &standing_}) {
    if (tree->empty()) continue;
    low.setMin(tree->m_root->volume.Mins()), high.setMax(tree->m_root->volume.Maxs());
  }
}

void Broadphase::calculateOverlappingPairs(btDispatcher* dispatcher) {
  constexpr std::size_t kAtOnce = 64;
  moving_.optimizeIncremental(1);
  if (statics_to_place_ > 0) {
    const std::size_t now = std::min(statics_to_place_, 1 + statics_to_place_ / kLooksForStatics);
    standing_.optimizeIncremental(static_cast<int>(now));
    statics_to_place_ -= now;
  }
  if (used_room_.is_spare(moved_.size())) {
    for (List& list : lists_) list = {};
    moved_.shrink_to_fit();
    core::free_memory(looked_in_);
  }
  if (moved_.empty()) return;
  if (statics_ != nullptr) bring_statics();
  std::atomic<std::size_t> taken = 0;
  team_.side_by_side([&](const soft::Worker& worker) {
    List& list = lists_[static_cast<std::size_t>(worker.number)];
    for (std::size_t first = taken.fetch_add(kAtOnce); first < moved_.size(); first = taken.fetch_add(kAtOnce)) {
      core::Progress::mark();
      for (std::size_t i = first; i < std::min(moved_.size(), first + kAtOnce); ++i) {
        if (moved_[i] != nullptr) look(list, *moved_[i]);
      }
    }
  });
  for (Proxy* proxy : moved_) {
    if (proxy != nullptr) proxy->moved = -1;
  }
  const std::size_t added = add_found();
  const auto all = static_cast<std::size_t>(pairs_.getNumOverlappingPairs());
  clean(std::min(all, std::max(added, std::min(1 + all / kLooksForAll, kPairsOfObject * moved_.size()))), dispatcher);
  moved_.clear();
}

void Broadphase::bring_statics() {
  looked_in_.clear();
  for (const Proxy* proxy : moved_) {
    if (proxy == nullptr || proxy->stands) continue;
    looked_in_.push_back({proxy->leaf->volume.Mins(), proxy->leaf->volume.Maxs()});
  }
  if (!looked_in_.empty()) statics_->bring(looked_in_);
}

/// Finds what is near an object and has no pair with it yet.
void Broadphase::look(List& list, Proxy& proxy) {
  look_in(moving_, list, proxy);
  if (!proxy.stands) look_in(standing_, list, proxy);
}

void Broadphase::look_in(const btDbvt& tree, List& list, Proxy& proxy) {
  if (tree.empty()) return;
  const btDbvtVolume& box = proxy.leaf->volume;
  list.stack.assign(1, tree.m_root);
  while (!list.stack.empty()) {
    const btDbvtNode* const node = list.stack.back();
    list.stack.pop_back();
    if (node->isinternal()) {
      for (const btDbvtNode* const child : node->childs) {
        if (Intersect(child->volume, box)) list.stack.push_back(child);
      }
      continue;
    }
    Proxy& other = *static_cast<Proxy*>(node->data);
    if (&other == &proxy || other.moved > proxy.moved) continue;  // the later one of two that have moved finds the pair
    if (!pairs_.needsBroadphaseCollision(&proxy, &other) || pairs_.contains(proxy, other)) continue;
    list.found.push_back({&proxy, &other});
  }
}

std::size_t Broadphase::add_found() {
  std::size_t added = 0;
  for (List& list : lists_) {
    for (const Near& two : list.found) {
      core::Progress::mark_now_and_then(added++);
      pairs_.addOverlappingPair(two.one, two.other);
    }
    list.found.clear();
  }
  return added;
}

/// Tests so many pairs, after those that were tested last, and removes those whose boxes are apart.
void Broadphase::clean(std::size_t count, btDispatcher* dispatcher) {
  const btBroadphasePairArray& pairs = pairs_.getOverlappingPairArray();
  const auto all = static_cast<std::size_t>(pairs.size());
  if (all == 0) return;
  team_.side_by_side([&](const soft::Worker& worker) {
    List& list = lists_[static_cast<std::size_t>(worker.number)];
    const auto [first, last] = worker.share(count);
    for (std::size_t i = first; i < last; ++i) {
      const btBroadphasePair& pair = pairs[static_cast<int>((next_to_clean_ + i) % all)];
      Proxy &one = of(*pair.m_pProxy0), &other = of(*pair.m_pProxy1);
      if (!Intersect(one.leaf->volume, other.leaf->volume)) list.found.push_back({&one, &other});
    }
  });
  next_to_clean_ = (next_to_clean_ + count) % all;
  std::size_t removed = 0;
  for (List& list : lists_) {
    for (const Near& two : list.found) {
      core::Progress::mark_now_and_then(removed++);
      pairs_.removeOverlappingPair(two.one, two.other, dispatcher);
    }
    list.found.clear();
  }
}

}  // namespace aurasim::physics
