// What an observer is told of one node: what it wants, all of it, and whom it has to hear of from somebody else.
#include "node/observation_feed.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::node {
namespace {

using core::BodyId;
using core::Observation;
using core::RegionId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Observed : public ::testing::Test {
 protected:
  Observed() { interest_.all = true; }

  void place(std::uint64_t id, double x, std::uint32_t prototype = 0) {
    core::BodyState body;
    body.id = BodyId{id};
    body.prototype = core::PrototypeId{prototype};
    body.pose.p_WB.x() = x;
    bodies_[id] = body;
  }
  /// Takes it out of the world, as a hand-off does. After step().
  void send_away(std::uint64_t id, std::uint32_t destination) {
    core::BodyRecord record;
    record.id = BodyId{id};
    record.p_WB = bodies_.at(id).pose.p_WB;
    report_.departed.push_back(record);
    report_.departures.push_back({.stamp = step_, .body = record.id, .epoch = 1, .destination = RegionId{destination}});
    bodies_.erase(id);
  }
  void arrives(std::uint64_t id, double x) {
    place(id, x);
    report_.arrivals.push_back({.body = BodyId{id}});
  }
  void step() {
    report_ = {};
    report_.step = ++step_;
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i) {
      step();
      note();
    }
  }
  void note() { feed_.note(report_, open_); }

  Observation told(const std::vector<core::ContactImpulse>& contacts = {}) {
    core::Snapshot snapshot;
    snapshot.step = step_;
    for (const auto& [id, body] : bodies_) snapshot.bodies.push_back(body);
    return feed_.compose(interest_, snapshot, contacts, 5);
  }
  static std::vector<std::uint64_t> ids(const Observation& observation) {
    std::vector<std::uint64_t> ids;
    for (const core::ObservedBody& body : observation.bodies) ids.push_back(core::value_of(body.row.id));
    return ids;
  }
  void want_a_box(double from, double to) {
    interest_.all = false;
    interest_.boxes = {{{from, -1, -1}, {to, 1, 1}}};
  }

  core::Scene scene_;
  ObservationFeed feed_{{RegionId{1}, 4, 77, 2}, scene_};
  core::Interest interest_;
  std::map<std::uint64_t, core::BodyState> bodies_;
  std::deque<core::HandOff> open_;
  StepReport report_;
  core::Step step_ = 0;
};

TEST_F(Observed, SaysFromWhomAndOfWhatItIs) {
  interest_.sequence = 12;
  steps(3);
  const Observation observation = told();
  EXPECT_EQ(observation.source, RegionId{1});
  EXPECT_EQ(observation.generation, 4U);
  EXPECT_EQ(observation.map_version, 77U);
  EXPECT_EQ(observation.redo, 5U);
  EXPECT_EQ(observation.stamp, 3);
  EXPECT_EQ(observation.sequence, 12U);
  EXPECT_THAT(observation.bodies, IsEmpty());
}

TEST_F(Observed, IsWhatIsAskedForAndNothingElse) {
  place(1, 0);
  place(2, 5, 3);
  place(7, 9);
  place(8, 0);
  bodies_[8].birth = 10;
  EXPECT_THAT(ids(told()), ElementsAre(1, 2, 7)) << "8 is not born yet";
  interest_.all = false;
  EXPECT_THAT(ids(told()), IsEmpty());
  interest_.bodies = {BodyId{7}, BodyId{9}};
  EXPECT_THAT(ids(told()), ElementsAre(7));
  interest_.prototypes = {core::PrototypeId{3}};
  EXPECT_THAT(ids(told()), ElementsAre(2, 7));
  interest_.boxes = {{{-1, -1, -1}, {0, 0, 0}}};
  EXPECT_THAT(ids(told()), ElementsAre(1, 2, 7)) << "on a side is inside";
}

TEST_F(Observed, WhoLeavesIsExactInThatStateAndNamedInThoseAfterIt) {
  place(1, 0);
  place(2, 5);
  step();
  send_away(2, 3);
  note();
  Observation observation = told();
  ASSERT_THAT(ids(observation), ElementsAre(1, 2));
  EXPECT_FALSE(observation.bodies[1].stale);
  EXPECT_EQ(observation.bodies[1].row.host, RegionId{3});
  EXPECT_EQ(observation.bodies[1].row.epoch, 1U);
  steps(1);
  observation = told();
  ASSERT_THAT(ids(observation), ElementsAre(1, 2));
  EXPECT_TRUE(observation.bodies[1].stale);
  steps(40);
  EXPECT_THAT(ids(told()), ElementsAre(1)) << "its next host has told of it long ago";
}

TEST_F(Observed, WhoIsNotAcknowledgedIsNamedForAsLong) {
  place(2, 5);
  step();
  send_away(2, 3);
  note();
  core::HandOff hand_off;
  hand_off.cluster.bodies.emplace_back().id = BodyId{2};
  open_.push_back(hand_off);
  steps(40);
  EXPECT_THAT(ids(told()), ElementsAre(2));
}

TEST_F(Observed, WhoHasComeOrWasTakenOutIsAccountedForIfItIsNotWanted) {
  want_a_box(-1, 1);
  step();
  arrives(3, 0);
  arrives(4, 7);
  report_.removals.push_back({step_, BodyId{6}, ""});
  note();
  Observation observation = told();
  EXPECT_THAT(ids(observation), ElementsAre(3));
  EXPECT_THAT(observation.outside, ElementsAre(BodyId{4}, BodyId{6}));
  steps(40);
  EXPECT_THAT(told().outside, IsEmpty());
}

TEST_F(Observed, WhoIsUnderWayMayBeInABoxByNow) {
  want_a_box(-1, 1);
  place(2, 5);
  step();
  send_away(2, 3);
  note();
  EXPECT_THAT(ids(told()), IsEmpty()) << "in this state it is outside";
  EXPECT_THAT(told().outside, ElementsAre(BodyId{2}));
  steps(1);
  EXPECT_THAT(ids(told()), ElementsAre(2));
}

TEST_F(Observed, WhoComesBackIsHereAgain) {
  place(2, 5);
  step();
  send_away(2, 3);
  note();
  step();
  arrives(2, 6);
  note();
  const Observation observation = told();
  ASSERT_THAT(ids(observation), ElementsAre(2));
  EXPECT_FALSE(observation.bodies[0].stale);
  EXPECT_EQ(observation.bodies[0].row.host, RegionId{1});
}

TEST_F(Observed, WhoPassesThroughInOneStateIsExactInIt) {
  step();
  arrives(2, 5);
  send_away(2, 3);
  note();
  const Observation observation = told();
  ASSERT_THAT(ids(observation), ElementsAre(2));
  EXPECT_FALSE(observation.bodies[0].stale);
  EXPECT_EQ(observation.bodies[0].row.host, RegionId{3});
}

TEST_F(Observed, OfMadeUpStatesAllBodiesAreAccountedFor) {
  want_a_box(-1, 1);
  MadeUp state;
  state.step = 9;
  state.bodies.resize(2);
  state.bodies[0].id = BodyId{3};
  state.bodies[1].id = BodyId{4};
  state.bodies[1].p_WB.x() = 5;
  const Observation observation = feed_.compose(interest_, state, 0);
  EXPECT_EQ(observation.kind, Observation::Kind::kMadeUp);
  EXPECT_EQ(observation.stamp, 9);
  EXPECT_THAT(ids(observation), ElementsAre(3));
  EXPECT_THAT(observation.outside, ElementsAre(BodyId{4}));
}

TEST_F(Observed, ContactsAreThoseOfBodiesThatAreWanted) {
  place(1, 0);
  place(2, 5);
  place(3, 6);
  const std::vector<core::ContactImpulse> contacts = {
      {1, -1, {}, {0, 0, 1}, 2}, {1, 2, {}, {0, 0, 1}, 3}, {2, 3, {}, {0, 0, 1}, 4}};
  EXPECT_THAT(told(contacts).contacts, IsEmpty()) << "nobody has asked";
  interest_.contacts = true;
  EXPECT_EQ(told(contacts).contacts.size(), 3U);
  interest_.all = false;
  interest_.bodies = {BodyId{1}};
  EXPECT_EQ(told(contacts).contacts.size(), 2U);
}

}  // namespace
}  // namespace aurasim::node
