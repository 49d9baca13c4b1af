#include "physics/broadphase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/progress.h"

namespace aurasim::physics {
namespace {

/// A box is larger than the bounds by this on all sides, m.
constexpr btScalar kMargin_m = btScalar(0.05);
/// An object that moves gets a box for so many steps on, but not larger than twice its bounds.
constexpr btScalar kStepsAhead = 6;
/// A thread takes so many objects that have left their boxes at once.
constexpr std::size_t kMovedAtOnce = 64;
/// In each look, one pair in so many is tested for whether it is still near, but no more than so many for each object
/// that has left its box.
constexpr std::size_t kLooksForAll = 10, kPairsOfObject = 8;
/// In each look, one static in so many is given a better place in the tree, until each has been.
constexpr std::size_t kLooksForStatics = 100;
/// For each static that comes, so many are given a better place.
constexpr std::size_t kPlacedForOne = 4;

/// Side of a column, m. Objects that move are in one tree for each square column, so that several threads can change
/// the trees. Columns that are kColumns apart along x or y share a tree.
constexpr btScalar kColumn_m = 16;
constexpr int kColumns = 8;

int column_of(btScalar x) {
  if (!(std::abs(x) < btScalar(1e9))) return 0;
  return static_cast<int>(static_cast<std::int64_t>(std::floor(x / kColumn_m)) & (kColumns - 1));
}
std::size_t column_of(const btDbvtVolume& box) {
  const btVector3 centre = box.Center();
  return static_cast<std::size_t>(kColumns * column_of(centre.x()) + column_of(centre.y()));
}

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
  bool stands = false;     ///< it is in the tree of statics
  std::size_t column = 0;  ///< index in moving_, if it is in one of these
  int moved = -1;          ///< index in moved_; -1: it is in its box
};

Broadphase::Proxy& Broadphase::of(btBroadphaseProxy& proxy) { return static_cast<Proxy&>(proxy); }
const Broadphase::Proxy& Broadphase::of(const btBroadphaseProxy& proxy) { return static_cast<const Proxy&>(proxy); }
btDbvt& Broadphase::tree_of(const Proxy& proxy) { return proxy.stands ? standing_ : moving_[proxy.column]; }

Broadphase::Broadphase(ContactPairs& pairs, soft::Team& team)
    : pairs_(pairs),
      team_(team),
      moving_(kColumns * kColumns),
      thread_of_column_(moving_.size()),
      pieces_(team.size()),
      lists_(static_cast<std::size_t>(team.size())) {}

Broadphase::~Broadphase() = default;

btBroadphaseProxy* Broadphase::createProxy(const btVector3& low, const btVector3& high, int, void* object, int group,
                                           int mask, btDispatcher*) {
  auto* const proxy = new Proxy(low, high, object, group, mask);
  proxy->m_uniqueId = next_id_++;
  proxy->stands = (group & btBroadphaseProxy::StaticFilter) != 0;
  const btDbvtVolume box = volume_of(low, high);
  proxy->column = column_of(box);
  proxy->leaf = tree_of(*proxy).insert(box, proxy);
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

/// Sets the bounds of an object. Returns false with nothing done if they are not inside its box.
bool Broadphase::keep_in_box(Proxy& proxy, const Bounds& bounds) {
  if (!proxy.leaf->volume.Contain(volume_of(bounds.low, bounds.high))) return false;
  proxy.m_aabbMin = bounds.low, proxy.m_aabbMax = bounds.high;
  return true;
}

/// Sets the bounds of an object that has left its box. Returns its next box.
Broadphase::NewBox Broadphase::leave_box(Proxy& proxy, const Bounds& bounds) {
  const btVector3 margin(kMargin_m, kMargin_m, kMargin_m);
  btVector3 ahead = (bounds.low - proxy.m_aabbMin) * kStepsAhead;
  const btVector3 most = (bounds.high - bounds.low) / 2;
  for (int axis = 0; axis < 3; ++axis) ahead[axis] = std::clamp(ahead[axis], -most[axis], most[axis]);
  proxy.m_aabbMin = bounds.low, proxy.m_aabbMax = bounds.high;
  NewBox box{&proxy, volume_of(bounds.low - margin, bounds.high + margin), proxy.column, proxy.column};
  box.volume.SignedExpand(ahead);
  if (!proxy.stands) box.to = column_of(box.volume);
  return box;
}

void Broadphase::setAabb(btBroadphaseProxy* moved, const btVector3& low, const btVector3& high, btDispatcher*) {
  Proxy& proxy = of(*moved);
  if (keep_in_box(proxy, {low, high})) return;
  NewBox box = leave_box(proxy, {low, high});
  take_out(box);
  put_in(box);
  note_moved(proxy);
}

void Broadphase::bound(btBroadphaseProxy& moved, const Bounds& bounds, const soft::Worker& worker) {
  Proxy& proxy = of(moved);
  if (keep_in_box(proxy, bounds)) return;
  lists_[static_cast<std::size_t>(worker.number)].left.push_back(leave_box(proxy, bounds));
}

/// Takes an object out of its tree, or puts its box in another place there.
void Broadphase::take_out(NewBox& box) {
  Proxy& proxy = *box.proxy;
  if (box.from == box.to) return tree_of(proxy).update(proxy.leaf, box.volume);
  moving_[box.from].remove(proxy.leaf);
  proxy.leaf = nullptr;
}

/// Puts an object into its next tree.
void Broadphase::put_in(const NewBox& box) {
  if (box.from == box.to) return;
  box.proxy->column = box.to;
  box.proxy->leaf = moving_[box.to].insert(box.volume, box.proxy);
}

void Broadphase::give_boxes() {
  std::size_t count = 0;
  for (const List& list : lists_) count += list.left.size();
  if (count == 0) return;
  share_columns_out(count);
  const auto all_left = [this](auto&& visit) {
    for (List& list : lists_) std::ranges::for_each(list.left, visit);
  };
  team_.side_by_side([&](const soft::Worker& worker) {
    all_left([&](NewBox& box) {
      if (thread_of_column_[box.from] == worker.number) take_out(box);
    });
    worker.wait();
    all_left([&](const NewBox& box) {
      if (thread_of_column_[box.to] == worker.number) put_in(box);
    });
  });
  all_left([this](const NewBox& box) { note_moved(*box.proxy); });
  for (List& list : lists_) list.left.clear();
}

/// Gives each thread columns in which about equally many objects have left their boxes.
void Broadphase::share_columns_out(std::size_t count) {
  std::array<std::size_t, kColumns * kColumns> left{};
  for (const List& list : lists_) {
    for (const NewBox& box : list.left) ++left[box.from];
  }
  const auto threads = static_cast<std::size_t>(team_.employed());
  std::size_t before = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    thread_of_column_[i] = static_cast<int>(std::min(threads - 1, (2 * before + left[i]) * threads / (2 * count)));
    before += left[i];
  }
}

void Broadphase::getAabb(btBroadphaseProxy* proxy, btVector3& low, btVector3& high) const {
  low = proxy->m_aabbMin, high = proxy->m_aabbMax;
}

/// Calls visit(tree) for all trees that are not empty.
template <class Visit>
void Broadphase::for_each_tree(Visit&& visit) const {
  for (const btDbvt& tree : moving_) {
    if (!tree.empty()) visit(tree);
  }
  if (!standing_.empty()) visit(standing_);
}

void Broadphase::rayTest(const btVector3& from, const btVector3& to, btBroadphaseRayCallback& callback,
                         const btVector3& low, const btVector3& high) {
  if (statics_ != nullptr) bring_statics_on_way(from, to, {low, high});
  ForRays each;
  btAlignedObjectArray<const btDbvtNode*> stack;
  for_each_tree([&](const btDbvt& tree) {
    tree.rayTestInternal(tree.m_root, from, to, callback.m_rayDirectionInverse, callback.m_signs, callback.m_lambda_max,
                         low, high, stack, each);
  });
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
  const btDbvtVolume box = volume_of(where.low, where.high);
  btAlignedObjectArray<const btDbvtNode*> stack;
  for (const btDbvt& tree : moving_) {
    if (!tree.empty()) stack.push_back(tree.m_root);
  }
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
  for_each_tree([&](const btDbvt& tree) { tree.collideTV(tree.m_root, volume_of(low, high), each); });
}

void Broadphase::getBroadphaseAabb(btVector3& low, btVector3& high) const {
  low = high = btVector3(0, 0, 0);
  for_each_tree(
      [&](const btDbvt& tree) { low.setMin(tree.m_root->volume.Mins()), high.setMax(tree.m_root->volume.Maxs()); });
}

void Broadphase::calculateOverlappingPairs(btDispatcher* dispatcher) {
  moving_[next_to_improve_++ % moving_.size()].optimizeIncremental(1);
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
  pieces_.begin(moved_.size(), team_.employed(), kMovedAtOnce);
  team_.side_by_side([&](const soft::Worker& worker) {
    List& list = lists_[static_cast<std::size_t>(worker.number)];
    pieces_.work_off(worker, [&](std::size_t first, std::size_t last) {
      core::Progress::mark();
      for (std::size_t i = first; i < last; ++i) {
        if (moved_[i] != nullptr) look(list, *moved_[i]);
      }
    });
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
  for (const btDbvt& tree : moving_) look_in(tree, list, proxy);
  if (!proxy.stands) look_in(standing_, list, proxy);
}

void Broadphase::look_in(const btDbvt& tree, List& list, Proxy& proxy) {
  const btDbvtVolume& box = proxy.leaf->volume;
  if (tree.empty() || !Intersect(tree.m_root->volume, box)) return;
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
