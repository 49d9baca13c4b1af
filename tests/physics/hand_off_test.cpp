// One world ("central") against two, between which bodies are handed over.
#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::BodyRecord;
using core::ClusterState;
using core::Step;
using Ids = std::vector<std::uint64_t>;

class HandOff : public ::testing::Test {
 protected:
  /// Into the one world, and into the first of the two.
  void place(const std::vector<BodyRecord>& bodies) {
    central.add(bodies);
    first.add(bodies);
    for (const BodyId id : ids_of(bodies)) ids.push_back(id);
  }

  void run_all(int steps) {
    run(central, steps);
    run(first, steps);
    run(second, steps);
  }

  void hand_over() { second.adopt(first.release(ids), second.step_number()); }
  void hand_back() { first.adopt(second.release(ids), first.step_number()); }

  Ids that_differ() {
    Ids result = different(first.records(), central.records());
    for (const std::uint64_t id : different(second.records(), central.records())) result.push_back(id);
    return result;
  }

  std::size_t sleepers(RegionWorld& world) {
    return static_cast<std::size_t>(
        std::ranges::count_if(world.snapshot().bodies, [](const auto& b) { return !b.awake; }));
  }

  core::Scene scene = scene_of_all_shapes();
  std::mt19937_64 random{7};
  RegionWorld central{scene, Settings{}}, first{scene, Settings{}}, second{scene, Settings{}};
  std::vector<BodyId> ids;
};

TEST_F(HandOff, SameBitsWhateverTheOrderOfInsertion) {
  std::vector<BodyRecord> bodies = pile(random, 1, 20, 0, 0);
  const std::vector<BodyRecord> more = pile(random, 100, 20, 30, 0);
  bodies.insert(bodies.end(), more.begin(), more.end());
  central.add(bodies);
  std::shuffle(bodies.begin(), bodies.end(), random);
  for (const BodyRecord& body : bodies) first.add(std::span(&body, 1));
  for (int i = 0; i < 600; ++i) {
    run_all(1);
    ASSERT_EQ(that_differ(), Ids()) << "in state " << i + 1;
  }
}

TEST_F(HandOff, InMidFallChangesNoBit) {
  place(pile(random, 1, 12, 0, 0));
  run_all(10);
  hand_over();
  run_all(600);
  EXPECT_EQ(that_differ(), Ids());
}

TEST_F(HandOff, AmongBodiesThatAreThereAlreadyChangesNoBit) {
  place(pile(random, 1, 12, 0, 0));
  const std::vector<BodyRecord> residents = pile(random, 100, 12, 40, 0);
  central.add(residents);
  second.add(residents);
  for (int i = 0; i < 20; ++i) {
    run_all(7);
    hand_over();
    run_all(6);
    hand_back();
  }
  EXPECT_EQ(that_differ(), Ids());
}

TEST_F(HandOff, OfARestingStackMovesNothing) {
  place(stack(1, 5, 0, 0));
  run_all(100);
  hand_over();
  run_all(300);
  EXPECT_EQ(that_differ(), Ids());
}

TEST_F(HandOff, WithoutTheContactCacheKicksARestingStack) {
  place(stack(1, 5, 0, 0));
  run_all(100);
  ClusterState cluster = first.release(ids);
  EXPECT_FALSE(cluster.manifolds.empty());
  cluster.manifolds.clear();
  second.adopt(cluster, second.step_number());
  run_all(1);
  EXPECT_EQ(that_differ().size(), 5u) << "or the other tests of this file could not fail";
}

TEST_F(HandOff, LeavesASleepingPileAsleep) {
  place(stack(1, 4, 0, 0));
  run_all(400);
  ASSERT_EQ(sleepers(first), 4u);
  hand_over();
  EXPECT_EQ(sleepers(second), 4u);
  run_all(100);
  EXPECT_EQ(sleepers(second), 4u);
  EXPECT_EQ(that_differ(), Ids());
}

TEST_F(HandOff, OfASleepingPileWakesUpAsIfItHadStayed) {
  place(stack(1, 4, 0, 0));
  run_all(400);
  ASSERT_EQ(sleepers(first), 4u);
  hand_over();
  const std::vector<BodyRecord> stone = {body(50, kSphere, {-3, 0.1, 2.5}, {12, 0, 0})};
  central.add(stone);
  second.add(stone);
  for (int i = 0; i < 300; ++i) {
    run_all(1);
    ASSERT_EQ(that_differ(), Ids()) << i + 1 << " steps after the throw";
  }
}

TEST_F(HandOff, KeepsEveryManifoldOfTwoCompounds) {
  // Two hammers lying across each other, which touch with several parts.
  std::vector<BodyRecord> hammers = {body(1, kCompound, {0, 0, 0.3}), body(2, kCompound, {0.05, 0, 0.7})};
  hammers[0].R_WB = core::Quat(Eigen::AngleAxisd(1.5, core::Vec3::UnitX())).toRotationMatrix();
  hammers[1].R_WB = core::Quat(Eigen::AngleAxisd(1.6, core::Vec3::UnitX())).toRotationMatrix();
  place(hammers);
  std::size_t most = 0;
  for (int i = 0; i < 100; ++i) {
    run_all(2);
    const ClusterState before = first.peek(ids);
    hand_over();
    const ClusterState after = second.peek(ids);
    most = std::max<std::size_t>(most,
                                 static_cast<std::size_t>(std::ranges::count_if(
                                     before.manifolds, [](const auto& m) { return m.object0 > 0 && m.object1 > 0; })));
    ASSERT_EQ(after.points, before.points);
    ASSERT_EQ(after.manifolds.size(), before.manifolds.size());
    run_all(1);
    ASSERT_EQ(that_differ(), Ids());
    hand_back();
  }
  EXPECT_GT(most, 1u) << "the hammers never touched with two parts at once";
}

class CatchUp : public HandOff, public ::testing::WithParamInterface<int> {};

TEST_P(CatchUp, EqualsHavingStayed) {
  place(pile(random, 1, 12, 0, 0));
  run_all(40);
  for (int i = 0; i < 30; ++i) {
    const Step stamp = first.step_number();
    const ClusterState cluster = first.release(ids);
    run_all(GetParam());
    second.adopt(cluster, stamp);
    ASSERT_EQ(second.body_count(), ids.size());
    ASSERT_EQ(that_differ(), Ids());
    run_all(5);
    hand_back();
  }
}

TEST_P(CatchUp, TellsEveryStateThatItMakesUp) {
  place(pile(random, 1, 12, 0, 0));
  run_all(40);
  const Step stamp = first.step_number();
  const ClusterState cluster = first.release(ids);
  std::vector<std::uint64_t> expected;
  for (int i = 0; i < GetParam(); ++i) {
    run_all(1);
    expected.push_back(hash_sum(central.records()));
  }
  std::vector<std::uint64_t> told;
  second.adopt(cluster, stamp, [&](Step step, auto bodies) {
    EXPECT_EQ(step, stamp + 1 + static_cast<Step>(told.size()));
    told.push_back(hash_sum(bodies));
  });
  EXPECT_EQ(told, expected);
}

INSTANTIATE_TEST_SUITE_P(StepsLate, CatchUp, ::testing::Values(1, 2, 5));

TEST_F(HandOff, BeforeItsTimeIsRefused) {
  place(stack(1, 1, 0, 0));
  EXPECT_THROW(second.adopt(first.peek(ids), 1), std::invalid_argument);
}

TEST_F(HandOff, PeekTakesNothingAway) {
  place(stack(1, 3, 0, 0));
  run_all(50);
  const ClusterState seen = first.peek(ids);
  EXPECT_EQ(first.body_count(), 3u);
  const ClusterState taken = first.release(ids);
  EXPECT_EQ(hash_sum(seen.bodies), hash_sum(taken.bodies));
  EXPECT_EQ(seen.points, taken.points);
  EXPECT_EQ(first.body_count(), 0u);
}

TEST_F(HandOff, ListsBodiesAndManifoldsInOrder) {
  place(pile(random, 1, 12, 0, 0));
  run_all(200);
  std::ranges::reverse(ids);
  const ClusterState cluster = first.release(ids);
  EXPECT_TRUE(std::ranges::is_sorted(cluster.bodies, {}, &BodyRecord::id));
  EXPECT_TRUE(
      std::ranges::is_sorted(cluster.manifolds, {}, [](const auto& m) { return std::pair(m.object0, m.object1); }));
  std::size_t points = 0;
  for (const core::ManifoldRecord& manifold : cluster.manifolds) {
    EXPECT_EQ(manifold.first_point, points);
    points += manifold.point_count;
  }
  EXPECT_EQ(cluster.points.size(), points * core::kContactPointDoubles);
}

TEST_F(HandOff, OfPartOfAClusterIsCounted) {
  place(stack(1, 4, 0, 0));
  run_all(50);
  EXPECT_EQ(first.severed_contacts(), 0u);
  first.release(std::vector{ids[0], ids[2]});
  EXPECT_EQ(first.severed_contacts(), 3u);
  first.release(std::vector{ids[1], ids[3]});
  EXPECT_EQ(first.severed_contacts(), 3u);
}

TEST_F(HandOff, OfABodyThatIsNotHereIsRefused) {
  place(stack(1, 2, 0, 0));
  EXPECT_THROW(first.release(std::vector{BodyId{1}, BodyId{99}}), std::invalid_argument);
  EXPECT_EQ(first.body_count(), 2u);
}

}  // namespace
}  // namespace aurasim::physics::testing
