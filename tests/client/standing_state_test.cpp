// One state of a whole world from the key frames of its regions.
#include "agent/standing_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::agent {
namespace {

using core::BodyId;
using core::RegionId;

constexpr core::Generation kGeneration = 2;
constexpr core::Step kStep = 50;

core::Replica key_frame(std::uint32_t source, core::Step step = kStep) {
  core::Replica frame;
  frame.source = RegionId{source};
  frame.generation = kGeneration;
  frame.stamp = step;
  frame.key_frame = true;
  return frame;
}

void add(core::Replica& frame, std::uint64_t id, core::Epoch epoch, std::uint32_t host) {
  core::ReplicaBody row;
  row.id = BodyId{id};
  row.epoch = epoch;
  row.host = RegionId{host};
  frame.bodies.push_back(row);
}

const std::set<RegionId> kBoth = {RegionId{0}, RegionId{1}};

TEST(StandingState, IsCompleteWhenAllRegionsHaveGivenOneState) {
  StandingState state(kGeneration, kStep);
  state.accept(key_frame(0, kStep + 1));
  EXPECT_FALSE(state.is_complete(kBoth));
  state.accept(key_frame(1, kStep));
  EXPECT_FALSE(state.is_complete(kBoth)) << "of two states";
  state.accept(key_frame(1, kStep + 1));
  EXPECT_TRUE(state.is_complete(kBoth));
  EXPECT_EQ(state.step(), kStep + 1);
}

TEST(StandingState, WhatIsEarlierOrOfAnotherWorldOrNoKeyFrameDoesNotCount) {
  StandingState state(kGeneration, kStep);
  state.accept(key_frame(0, kStep - 1));
  core::Replica other = key_frame(0);
  other.generation = kGeneration - 1;
  state.accept(other);
  core::Replica delta = key_frame(0);
  delta.key_frame = false;
  state.accept(delta);
  EXPECT_FALSE(state.is_complete({RegionId{0}}));
  EXPECT_FALSE(state.is_complete({})) << "nobody is no world";
}

TEST(StandingState, TheHighestEpochIsTheTruthAndUnderOneEpochTheHost) {
  core::Replica first = key_frame(0), second = key_frame(1);
  add(first, 7, 3, 0);
  add(first, 8, 2, 1);  // on its way to region 1
  add(first, 9, 4, 1);  // has arrived there, and is not acknowledged yet
  add(second, 5, 1, 1);
  add(second, 7, 2, 1);  // is not told yet that it has gone on
  add(second, 9, 4, 1);
  StandingState state(kGeneration, kStep);
  state.accept(first);
  state.accept(second);
  ASSERT_TRUE(state.is_complete(kBoth));
  const std::vector<WorldBody> bodies = state.bodies();
  std::vector<std::uint64_t> ids;
  for (const WorldBody& body : bodies) ids.push_back(core::value_of(body.row.id));
  EXPECT_THAT(ids, ::testing::ElementsAre(5, 7, 8, 9));
  EXPECT_EQ(bodies[1].row.epoch, 3U);
  EXPECT_TRUE(bodies[2].under_way);
  EXPECT_FALSE(bodies[3].under_way);
}

core::Observation told_by(std::uint32_t source, core::Step step = kStep) {
  core::Observation told;
  told.source = RegionId{source};
  told.generation = kGeneration;
  told.stamp = step;
  return told;
}

void add(core::Observation& told, std::uint64_t id, std::uint32_t host, bool stale, double x) {
  core::ObservedBody body;
  body.row.id = BodyId{id};
  body.row.epoch = 2;
  body.row.host = RegionId{host};
  body.row.p_WB.x() = x;
  body.stale = stale;
  told.bodies.push_back(body);
}

TEST(StandingState, OfABodyUnderWayTheNewHostTellsWhereItIs) {
  StandingState state(kGeneration, kStep);
  core::Observation former = told_by(0);
  add(former, 7, 1, true, 1);
  add(former, 8, 1, false, 5);  // has left in this very state
  state.accept(former);
  state.accept(told_by(1));
  ASSERT_TRUE(state.is_complete(kBoth));
  EXPECT_THAT(state.missing(), ::testing::ElementsAre(BodyId{7}));
  core::Observation earlier = told_by(1, kStep - 1), foreseen = told_by(1);
  earlier.kind = foreseen.kind = core::Observation::Kind::kMadeUp;
  add(earlier, 7, 1, false, 2);
  add(foreseen, 7, 1, false, 3);
  state.accept(earlier);
  EXPECT_FALSE(state.missing().empty()) << "of an earlier state";
  state.accept(foreseen);
  EXPECT_TRUE(state.missing().empty());
  const std::vector<WorldBody> bodies = state.bodies();
  ASSERT_EQ(bodies.size(), 2U);
  EXPECT_EQ(bodies[0].row.p_WB.x(), 3);
  EXPECT_TRUE(bodies[0].under_way && bodies[1].under_way);
}

TEST(StandingState, WhatARegionHadThatHasDiedSinceIsNotOfThisState) {
  StandingState state(kGeneration, kStep);
  core::Replica dead = key_frame(0);
  add(dead, 1, 1, 0);
  state.accept(dead);
  state.accept(key_frame(1, kStep + 2));
  EXPECT_TRUE(state.is_complete({RegionId{1}}));
  EXPECT_TRUE(state.bodies().empty());
}

}  // namespace
}  // namespace aurasim::agent
