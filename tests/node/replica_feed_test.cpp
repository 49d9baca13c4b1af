// What is published for observers: all that changed, once, and everything in a key frame.
#include "node/replica_feed.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::node {
namespace {

using core::BodyId;
using core::RegionId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Feed : public ::testing::Test {
 protected:
  void place(std::uint64_t id, double x, core::Epoch epoch = 0) {
    core::BodyState body;
    body.id = BodyId{id};
    body.epoch = epoch;
    body.pose.p_WB.x() = x;
    bodies_[id] = body;
  }
  core::BodyState& body(std::uint64_t id) { return bodies_.at(id); }

  const core::Snapshot& snapshot() {
    snapshot_.step = step_;
    snapshot_.bodies.clear();
    for (const auto& [id, body] : bodies_) snapshot_.bodies.push_back(body);
    return snapshot_;
  }
  const core::Replica& publish() {
    step_ += 3;
    return feed_.compose_changes(snapshot());
  }
  std::vector<std::uint64_t> published() {
    std::vector<std::uint64_t> ids;
    for (const core::ReplicaBody& body : publish().bodies) ids.push_back(core::value_of(body.id));
    return ids;
  }
  /// Takes it out of the world, as a hand-off does.
  void send_away(std::uint64_t id, std::uint32_t destination) {
    core::BodyRecord record;
    record.id = BodyId{id};
    record.epoch = body(id).epoch;
    record.p_WB = body(id).pose.p_WB;
    StepReport report;
    report.step = step_;
    report.departed = {record};
    report.departures = {
        {.stamp = step_, .body = record.id, .epoch = record.epoch + 1, .destination = RegionId{destination}}};
    bodies_.erase(id);
    feed_.note(report);
  }

  ReplicaFeed feed_{RegionId{1}, 4, 77};
  std::map<std::uint64_t, core::BodyState> bodies_;
  core::Snapshot snapshot_;
  core::Step step_ = 0;
};

TEST_F(Feed, SaysFromWhomAndWhenAndCountsItsTicks) {
  place(3, 0);
  const core::Replica& first = publish();
  EXPECT_EQ(first.source, RegionId{1});
  EXPECT_EQ(first.generation, 4U);
  EXPECT_EQ(first.map_version, 77U);
  EXPECT_EQ(first.stamp, 3);
  EXPECT_EQ(first.sequence, 1U);
  EXPECT_FALSE(first.key_frame);
  EXPECT_EQ(publish().sequence, 2U);
}

/// The last snapshot with the next number, of which the bodies of `changed` may differ from before.
core::Snapshot next_of(core::Snapshot snapshot, std::vector<std::uint32_t> changed) {
  ++snapshot.number;
  ++snapshot.step;
  snapshot.goes_on = true;
  snapshot.born = snapshot.bodies.size();
  snapshot.changed = std::move(changed);
  return snapshot;
}

TEST_F(Feed, LooksAtTheBodiesThatSnapshotsSinceTheLastTickCallChanged) {
  for (const std::uint64_t id : {1U, 2U, 3U, 4U}) place(id, 0);
  core::Snapshot now = next_of(snapshot(), {});
  EXPECT_EQ(feed_.compose_changes(now).bodies.size(), 4U) << "nothing is known of earlier snapshots";
  now.bodies[1].pose.p_WB.x() = 1;
  now = next_of(now, {1});
  feed_.note(now);
  now.bodies[3].pose.p_WB.x() = 1;
  now.bodies[0].pose.p_WB.x() = 1;  // not called changed
  now = next_of(now, {3});
  const core::Replica& changes = feed_.compose_changes(now);
  ASSERT_EQ(changes.bodies.size(), 2U);
  EXPECT_EQ(changes.bodies[0].id, BodyId{2});
  EXPECT_EQ(changes.bodies[1].id, BodyId{4});
  now = next_of(next_of(now, {}), {});  // the feed has not seen the one between
  EXPECT_EQ(feed_.compose_changes(now).bodies.size(), 1U);
}

TEST_F(Feed, TellsOnlyWhatChanged) {
  place(1, 0);
  place(2, 5);
  EXPECT_THAT(published(), ElementsAre(1, 2));
  EXPECT_THAT(published(), IsEmpty());
  body(2).pose.p_WB.x() = 5.1;
  EXPECT_THAT(published(), ElementsAre(2));
  body(1).awake = false;
  EXPECT_THAT(published(), ElementsAre(1));
  EXPECT_THAT(published(), IsEmpty());
}

TEST_F(Feed, JitterIsNoNewsButCreepingIs) {
  place(1, 0);
  publish();
  std::size_t times = 0;
  for (int i = 1; i <= 100; ++i) {
    body(1).pose.p_WB.x() = 3e-5 * i;
    times += published().size();
  }
  EXPECT_GT(times, 10U);
  EXPECT_LT(times, 50U);
}

TEST_F(Feed, BodiesAreToldOnceTheyAreBorn) {
  place(1, 0);
  body(1).birth = 5;
  EXPECT_THAT(published(), IsEmpty());
  EXPECT_THAT(published(), ElementsAre(1));
}

TEST_F(Feed, ABodyThatLeftIsToldWithItsNewHostAndEpochAndItsLastPose) {
  place(1, 0, 6);
  publish();
  body(1).pose.p_WB.x() = 2;
  send_away(1, 3);
  const core::Replica& replica = publish();
  ASSERT_EQ(replica.bodies.size(), 1U);
  EXPECT_EQ(replica.bodies[0].host, RegionId{3});
  EXPECT_EQ(replica.bodies[0].epoch, 7U);
  EXPECT_EQ(replica.bodies[0].p_WB.x(), 2);
  EXPECT_THAT(replica.removed, IsEmpty());
  EXPECT_THAT(published(), IsEmpty());
}

TEST_F(Feed, ABodyThatCameAndLeftBetweenTwoTicksIsToldToo) {
  publish();
  place(8, 1, 2);
  send_away(8, 0);
  EXPECT_THAT(published(), ElementsAre(8));
}

TEST_F(Feed, ABodyThatLeftAndCameBackBetweenTwoTicksIsHere) {
  place(1, 0, 2);
  publish();
  send_away(1, 0);
  place(1, 0, 4);
  const core::Replica& replica = publish();
  ASSERT_EQ(replica.bodies.size(), 1U);
  EXPECT_EQ(replica.bodies[0].host, RegionId{1});
  EXPECT_EQ(replica.bodies[0].epoch, 4U);
}

TEST_F(Feed, ABodyThatIsNoMoreIsRemovedWithItsEpoch) {
  place(1, 0, 5);
  place(2, 0);
  publish();
  bodies_.erase(1);
  const core::Replica& replica = publish();
  EXPECT_THAT(replica.bodies, IsEmpty());
  ASSERT_EQ(replica.removed.size(), 1U);
  EXPECT_EQ(replica.removed[0].id, BodyId{1});
  EXPECT_EQ(replica.removed[0].epoch, 5U);
  EXPECT_THAT(publish().removed, IsEmpty());
}

TEST_F(Feed, ABodyThatGaveWayToAnotherCopyIsNotRemoved) {
  place(1, 0);
  publish();
  bodies_.erase(1);
  StepReport report;
  report.let_go = {BodyId{1}};
  feed_.note(report);
  const core::Replica& replica = publish();
  EXPECT_THAT(replica.bodies, IsEmpty());
  EXPECT_THAT(replica.removed, IsEmpty());
}

TEST_F(Feed, AKeyFrameHasAllThatIsHereAndAllThatIsOnItsWayFromHere) {
  place(1, 0);
  place(4, 0);
  body(4).awake = false;
  publish();
  core::HandOff hand_off;
  hand_off.destination = RegionId{2};
  hand_off.stamp = 3;
  core::BodyRecord record;
  record.id = BodyId{3};
  record.epoch = 9;
  hand_off.cluster.bodies = {record};
  const core::Replica& key = feed_.compose_key_frame(snapshot(), {hand_off});
  EXPECT_TRUE(key.key_frame);
  EXPECT_EQ(key.sequence, 1U);
  ASSERT_EQ(key.bodies.size(), 3U);
  EXPECT_EQ(key.bodies[0].id, BodyId{1});
  EXPECT_EQ(key.bodies[1].id, BodyId{3});
  EXPECT_EQ(key.bodies[1].host, RegionId{2});
  EXPECT_TRUE(key.bodies[2].asleep);
}

TEST_F(Feed, WantsAKeyFrameOnlyWhenSomethingWasTold) {
  place(1, 0);
  publish();
  EXPECT_TRUE(feed_.changed_since_key_frame());
  feed_.compose_key_frame(snapshot(), {});
  EXPECT_FALSE(feed_.changed_since_key_frame());
  publish();
  EXPECT_FALSE(feed_.changed_since_key_frame());
  body(1).pose.p_WB.x() = 1;
  publish();
  EXPECT_TRUE(feed_.changed_since_key_frame());
}

TEST_F(Feed, AfterAPauseInWhichNobodyListenedEverythingIsToldAnew) {
  place(1, 0);
  publish();
  feed_.forget();
  EXPECT_THAT(published(), ElementsAre(1));
}

TEST(TickSteps, AreWholeAndAtLeastOne) {
  EXPECT_EQ(tick_steps(60, 20), 3);
  EXPECT_EQ(tick_steps(60, 25), 2);
  EXPECT_EQ(tick_steps(60, 1000), 1);
}

}  // namespace
}  // namespace aurasim::node
