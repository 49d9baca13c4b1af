// Pairs of near objects: physics/broadphase.h.
#include "physics/broadphase.h"

#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

/// Boxes of random sizes that move at random, and some statics.
class Boxes {
 public:
  explicit Boxes(int threads) : team_(threads), broadphase_(pairs_, team_) {
    for (int i = 0; i < 300; ++i) add(i < 30);
  }
  ~Boxes() {
    while (!all_.empty()) remove(all_.size() - 1);
  }
  Boxes(const Boxes&) = delete;
  Boxes& operator=(const Boxes&) = delete;

  void add(bool is_static) {
    const btVector3 low = place(), high = low + btVector3(size(), size(), size());
    const int group = is_static ? btBroadphaseProxy::StaticFilter : btBroadphaseProxy::DefaultFilter;
    const int mask = is_static ? btBroadphaseProxy::AllFilter ^ group : btBroadphaseProxy::AllFilter;
    broadphase_.number_next(next_id_++);
    all_.push_back(broadphase_.createProxy(low, high, 0, nullptr, group, mask, nullptr));
  }
  void remove(std::size_t i) {
    broadphase_.destroyProxy(all_[i], nullptr);
    all_.erase(all_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  /// Moves all that is not static by up to `most_m` along each axis.
  void move(double most_m) {
    std::vector<std::pair<btBroadphaseProxy*, Bounds>> moved;
    for (btBroadphaseProxy* proxy : all_) {
      if (is_static(*proxy)) continue;
      const btVector3 by(uniform(random_, -most_m, most_m), uniform(random_, -most_m, most_m),
                         uniform(random_, -most_m, most_m));
      moved.push_back({proxy, {proxy->m_aabbMin + by, proxy->m_aabbMax + by}});
    }
    team_.employ_for(10000);
    team_.side_by_side([&](const soft::Worker& worker) {
      const auto [first, last] = worker.share(moved.size());
      for (std::size_t i = first; i < last; ++i) broadphase_.bound(*moved[i].first, moved[i].second, worker);
    });
    broadphase_.give_boxes();
  }
  void look() { broadphase_.calculateOverlappingPairs(nullptr); }
  int pairs() const { return pairs_.getNumOverlappingPairs(); }
  std::size_t size_of() const { return all_.size(); }

  /// Number of pairs whose bounds overlap. Each must have been found.
  int expect_all_found() {
    int overlapping = 0;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        btBroadphaseProxy &a = *all_[i], &b = *all_[j];
        if (is_static(a) && is_static(b)) continue;
        bool overlap = true;
        for (int k = 0; k < 3; ++k) {
          overlap = overlap && a.m_aabbMin[k] <= b.m_aabbMax[k] && b.m_aabbMin[k] <= a.m_aabbMax[k];
        }
        if (!overlap) continue;
        ++overlapping;
        EXPECT_NE(pairs_.findPair(&a, &b), nullptr) << i << " and " << j;
      }
    }
    return overlapping;
  }

 private:
  static bool is_static(const btBroadphaseProxy& proxy) {
    return proxy.m_collisionFilterGroup == btBroadphaseProxy::StaticFilter;
  }
  /// Around a corner of four columns, each of which has a tree.
  btVector3 place() { return {uniform(random_, 10, 22), uniform(random_, -6, 6), uniform(random_, 0, 4)}; }
  double size() { return uniform(random_, 0.2, 1.5); }

  std::mt19937_64 random_{11};
  soft::Team team_;
  ContactPairs pairs_;
  Broadphase broadphase_;
  std::vector<btBroadphaseProxy*> all_;
  int next_id_ = 1;
};

TEST(Broadphase, FindsAllPairsThatOverlapWhileObjectsMoveComeAndGo) {
  for (const int threads : {1, 3}) {
    Boxes boxes(threads);
    for (int step = 0; step < 60; ++step) {
      boxes.move(step % 7 == 0 ? 1.0 : 0.03);
      if (step % 5 == 0) boxes.add(step % 2 == 0), boxes.remove(boxes.size_of() / 2);
      boxes.look();
      EXPECT_GT(boxes.expect_all_found(), 100);
      if (HasFailure()) return;
    }
  }
}

TEST(Broadphase, DropsPairsThatAreNearNoMore) {
  for (const int threads : {1, 3}) {
    Boxes boxes(threads);
    boxes.look();
    const int first = boxes.expect_all_found();
    for (int step = 0; step < 200; ++step) boxes.move(0.5), boxes.look();  // objects scatter
    EXPECT_LT(boxes.expect_all_found(), first / 2);
    EXPECT_LT(boxes.pairs(), first * 3);
  }
}

/// A body that has left since it moved is looked at no more.
TEST(Broadphase, AnObjectMayLeaveBeforeTheNextLook) {
  Boxes boxes(1);
  boxes.move(0.5);
  while (boxes.size_of() > 5) boxes.remove(boxes.size_of() - 1);
  boxes.look();
  boxes.expect_all_found();
}

}  // namespace
}  // namespace aurasim::physics::testing
