#include "physics/region_world.h"

#include <algorithm>
#include <cmath>

#include <LinearMath/btScalar.h>
#include <gtest/gtest.h>

#include "physics/scenes.h"
#include "physics/state_hash.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::BodyRecord;

class World : public ::testing::Test {
 protected:
  core::Scene scene = scene_of_all_shapes();
  std::mt19937_64 random{3};
  RegionWorld world{scene, Settings{}};
};

TEST_F(World, HasNoBodiesAtFirst) {
  EXPECT_EQ(world.step_number(), 0);
  EXPECT_EQ(world.body_count(), 0u);
  world.step();
  EXPECT_EQ(world.step_number(), 1);
  EXPECT_EQ(world.snapshot().step, 1);
  EXPECT_TRUE(world.snapshot().bodies.empty());
}

TEST_F(World, SnapshotIsInOrderOfIdsAndContacts) {
  std::vector<BodyRecord> bodies = pile(random, 1, 30, 0, 0);
  std::ranges::reverse(bodies);
  world.add(bodies);
  run(world, 150);
  const core::Snapshot& snapshot = world.snapshot();
  EXPECT_TRUE(std::ranges::is_sorted(snapshot.bodies, {}, &core::BodyState::id));
  const auto pair_of = [](const core::Contact& c) { return std::pair(c.a, c.b); };
  EXPECT_TRUE(std::ranges::is_sorted(snapshot.contacts, {}, pair_of));
  EXPECT_EQ(std::ranges::adjacent_find(snapshot.contacts, {}, pair_of), snapshot.contacts.end());
  EXPECT_GT(snapshot.contacts.size(), 3u);
  for (const core::Contact& contact : snapshot.contacts) {
    EXPECT_LT(contact.a, contact.b);
    EXPECT_LT(contact.b, snapshot.bodies.size());
  }
}

TEST_F(World, ContactsAreThoseOfTheStack) {
  world.add(stack(10, 4, 0, 0));
  run(world, 30);
  ASSERT_EQ(world.snapshot().contacts.size(), 3u);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(world.snapshot().contacts[i].a, i);
    EXPECT_EQ(world.snapshot().contacts[i].b, i + 1);
  }
}

/// Whatever the size: Bullet's own margin would be 0.7 m between these.
TEST_F(World, ContactsReachNoFartherThanTheMargin) {
  core::Scene big = scene_of(core::Capsule{20, 10});
  big.gravity.setZero();
  for (const double gap : {0.015, 0.025}) {
    RegionWorld huge(big, Settings{});
    huge.add(std::vector{body(1, 0, {0, 0, 100}), body(2, 0, {40 + gap, 0, 100})});
    huge.step();
    EXPECT_EQ(huge.snapshot().contacts.size(), gap < 0.02 ? 1u : 0u) << "at " << gap << " m";
  }
}

TEST_F(World, SnapshotAndRecordsSayTheSame) {
  world.add(pile(random, 1, 10, 0, 0));
  run(world, 50);
  const auto records = world.records();
  ASSERT_EQ(records.size(), world.snapshot().bodies.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const core::BodyState& state = world.snapshot().bodies[i];
    EXPECT_EQ(state.id, records[i].id);
    EXPECT_EQ(state.prototype, records[i].prototype);
    EXPECT_EQ(state.pose.p_WB, records[i].p_WB);
    EXPECT_LT((state.pose.q_WB.toRotationMatrix() - records[i].R_WB).norm(), 1e-5);
    EXPECT_EQ(state.v_WB, records[i].v_WB);
    EXPECT_EQ(state.w_WB, records[i].w_WB);
  }
}

TEST_F(World, EpochAndPrototypeTravelWithTheBody) {
  BodyRecord record = body(5, kHull, {0, 0, 3});
  record.epoch = 17;
  world.add(std::span(&record, 1));
  EXPECT_EQ(world.snapshot().bodies[0].epoch, 17u);
  const core::ClusterState cluster = world.release(std::vector{BodyId{5}});
  EXPECT_EQ(cluster.bodies[0].epoch, 17u);
  EXPECT_EQ(cluster.bodies[0].prototype, core::PrototypeId{kHull});
  EXPECT_FALSE(world.contains(BodyId{5}));
}

TEST_F(World, ARecordComesBackAsItWent) {
  BodyRecord record = pile(random, 5, 1, 0, 0)[0];
  record.deactivation_time = 0.5;
  record.block = core::block_at(record.p_WB, Settings{}.block_m);
  if (sizeof(btScalar) == sizeof(float)) {  // which can hold only rounded numbers
    for (double* number : {record.p_WB.data(), record.v_WB.data(), record.w_WB.data()}) {
      for (int i = 0; i < 3; ++i) number[i] = static_cast<float>(number[i]);
    }
    record.R_WB = record.R_WB.cast<float>().cast<double>();
  }
  world.add(std::span(&record, 1));
  EXPECT_EQ(state_hash(world.records()[0]), state_hash(record));
}

TEST_F(World, TheSameBodyTwiceIsRefused) {
  const std::vector<BodyRecord> twins = {body(1, kBox, {0, 0, 1}), body(1, kBox, {5, 0, 1})};
  EXPECT_THROW(world.add(twins), std::invalid_argument);
  EXPECT_EQ(world.body_count(), 0u);
  world.add(std::span(twins).first(1));
  EXPECT_THROW(world.add(std::span(twins).last(1)), std::invalid_argument);
  EXPECT_EQ(world.body_count(), 1u);
}

TEST_F(World, AnIdTooLargeForBulletIsRefused) {
  world.add(std::vector{body(2'000'000'000, kBox, {0, 0, 1})});
  EXPECT_THROW(world.add(std::vector{body(std::uint64_t{1} << 31, kBox, {5, 0, 1})}), std::invalid_argument);
  EXPECT_THROW(world.add(std::vector{body(std::uint64_t{1} << 40, kBox, {5, 0, 1})}), std::invalid_argument);
  EXPECT_EQ(world.body_count(), 1u);
  run(world, 30);
}

TEST_F(World, CanBeMoved) {
  world.add(stack(1, 3, 0, 0));
  run(world, 10);
  RegionWorld moved = std::move(world);
  run(moved, 10);
  EXPECT_EQ(moved.step_number(), 20);
  EXPECT_EQ(moved.body_count(), 3u);
}

TEST(StateHash, TellsEveryNumberOfTheState) {
  const BodyRecord original = body(3, kBox, {1, 2, 3}, {4, 5, 6});
  std::vector<BodyRecord> changed(18, original);
  changed[0].id = BodyId{4};
  changed[1].activation_state = 2;
  changed[2].deactivation_time = 1e-300;
  for (int i = 0; i < 3; ++i) changed[3 + i].p_WB[i] = std::nextafter(original.p_WB[i], 9);
  for (int i = 0; i < 3; ++i) changed[6 + i].v_WB[i] = std::nextafter(original.v_WB[i], 9);
  for (int i = 0; i < 3; ++i) changed[9 + i].w_WB[i] = 1e-300;
  for (int i = 0; i < 3; ++i) changed[12 + i].R_WB(i, 2 - i) += 1e-15;
  std::swap(changed[15].p_WB[0], changed[15].p_WB[1]);
  changed[16].block.x = 1;
  changed[17].block.y = 1;
  for (const BodyRecord& body : changed) EXPECT_NE(state_hash(body), state_hash(original));

  BodyRecord later = original;
  later.epoch = 9;
  EXPECT_EQ(state_hash(later), state_hash(original));

  std::uint64_t sum = 0;
  for (std::size_t count = 0; count <= changed.size(); ++count) {
    EXPECT_EQ(state_hash_sum(std::span(changed).first(count)), sum) << count << " bodies";
    if (count < changed.size()) sum += state_hash(changed[count]);
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
