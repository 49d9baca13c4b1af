// States of a whole world, from what its regions say of them.
#include "agent/merged_states.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::agent {
namespace {

using core::BodyId;
using core::Observation;
using core::RegionId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Merged : public ::testing::Test {
 protected:
  static Observation of(std::uint32_t source, core::Step step, std::uint32_t redo = 0,
                        core::Generation generation = 2) {
    Observation observation;
    observation.source = RegionId{source};
    observation.generation = generation;
    observation.redo = redo;
    observation.stamp = step;
    return observation;
  }
  static void add(Observation& to, std::uint64_t id, std::uint32_t host, core::Epoch epoch = 0, bool stale = false) {
    core::ObservedBody body;
    body.row.id = BodyId{id};
    body.row.host = RegionId{host};
    body.row.epoch = epoch;
    body.stale = stale;
    to.bodies.push_back(body);
  }
  static Observation made_up(std::uint32_t source, core::Step step, std::uint64_t id) {
    Observation observation = of(source, step);
    observation.kind = Observation::Kind::kMadeUp;
    add(observation, id, source, 1);
    observation.bodies.back().row.p_WB.x() = 7;
    return observation;
  }
  void both(core::Step step, std::uint32_t redo = 0) {
    states_.accept(of(0, step, redo), now_s_);
    states_.accept(of(1, step, redo), now_s_);
  }
  std::vector<MergedState> take() { return states_.take(kBoth, now_s_); }
  std::vector<core::Step> steps() {
    std::vector<core::Step> steps;
    for (const MergedState& state : take()) steps.push_back(state.step);
    return steps;
  }

  const std::set<RegionId> kBoth = {RegionId{0}, RegionId{1}};
  MergedStates states_{{.latest_steps = 4, .patience_s = 1}};
  double now_s_ = 10;
};

TEST_F(Merged, AStateIsWholeWhenAllRegionsHaveToldIt) {
  states_.accept(of(0, 5), now_s_);
  EXPECT_THAT(steps(), IsEmpty());
  states_.accept(of(1, 5), now_s_);
  EXPECT_THAT(steps(), ElementsAre(5));
  EXPECT_THAT(steps(), IsEmpty()) << "once";
  states_.accept(of(1, 5), now_s_);
  states_.accept(of(0, 4), now_s_);
  EXPECT_THAT(steps(), IsEmpty()) << "too late";
}

TEST_F(Merged, AStateThatARegionHasLeftOutIsNotGiven) {
  both(4);
  for (const core::Step step : {5, 6, 7, 8}) states_.accept(of(0, step), now_s_);
  EXPECT_THAT(steps(), ElementsAre(4));
  Observation next = of(1, 8);
  next.previous = 4;
  states_.accept(next, now_s_);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 1U) << "5, 6 and 7 are of one region alone, and always will be";
  EXPECT_EQ(taken[0].step, 8);
  EXPECT_TRUE(taken[0].is_complete());
}

TEST_F(Merged, AStateThatWasToldAndHasNotComeIsGivenAsFarAsItIsKnown) {
  both(4);
  for (const core::Step step : {5, 6, 7}) states_.accept(of(0, step), now_s_);
  Observation next = of(1, 7);
  next.previous = 6;  // 5 and 6 were overwritten on their way
  states_.accept(next, now_s_);
  EXPECT_THAT(steps(), ElementsAre(4, 5, 6, 7));
}

TEST_F(Merged, WhatWasLeftOutBeforeARedoIsTold) {
  both(4);
  states_.accept(of(0, 8), now_s_);
  Observation next = of(1, 8);
  next.previous = 4;
  states_.accept(next, now_s_);
  EXPECT_THAT(steps(), ElementsAre(4, 8));
  for (const core::Step step : {5, 6, 7}) both(step, 1);
  EXPECT_THAT(steps(), ElementsAre(5, 6, 7));
}

TEST_F(Merged, StatesComeInTheirOrder) {
  Observation left = of(0, 5);
  add(left, 3, 1, 1, true);
  states_.accept(left, now_s_);
  states_.accept(of(1, 5), now_s_);
  both(6);
  EXPECT_THAT(steps(), IsEmpty()) << "5 waits for body 3";
  states_.accept(made_up(1, 5, 3), now_s_);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_TRUE(taken[0].is_complete());
  ASSERT_EQ(taken[0].bodies.size(), 1U);
  EXPECT_EQ(taken[0].bodies[0].row.p_WB.x(), 7) << "the exact row counts";
}

TEST_F(Merged, WhatIsMadeUpMayComeFirst) {
  states_.accept(made_up(1, 5, 3), now_s_);
  Observation left = of(0, 5);
  add(left, 3, 1, 1, true);
  states_.accept(left, now_s_);
  states_.accept(of(1, 5), now_s_);
  EXPECT_THAT(steps(), ElementsAre(5));
}

TEST_F(Merged, WhoIsOutsideIsNotMissing) {
  Observation left = of(0, 5), there = of(1, 5);
  add(left, 3, 1, 1, true);
  there.outside = {BodyId{3}};
  states_.accept(left, now_s_);
  states_.accept(there, now_s_);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_TRUE(taken[0].is_complete());
  EXPECT_THAT(taken[0].bodies, IsEmpty());
}

TEST_F(Merged, WhatDoesNotComeIsNamed) {
  Observation left = of(0, 5);
  add(left, 3, 1, 1, true);
  states_.accept(left, now_s_);
  states_.accept(of(1, 5), now_s_);
  for (core::Step step = 6; step <= 9; ++step) both(step);
  EXPECT_THAT(steps(), IsEmpty());
  both(10);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 6U);
  EXPECT_THAT(taken[0].missing, ElementsAre(BodyId{3}));
  ASSERT_EQ(taken[0].bodies.size(), 1U);
  EXPECT_TRUE(taken[0].bodies[0].under_way);
  EXPECT_TRUE(taken[1].is_complete());
}

TEST_F(Merged, NothingIsWaitedForTooLong) {
  Observation left = of(0, 5);
  add(left, 3, 1, 1, true);
  states_.accept(left, now_s_);
  states_.accept(of(1, 5), now_s_);
  EXPECT_THAT(steps(), IsEmpty());
  now_s_ += 1.1;
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_THAT(taken[0].missing, ElementsAre(BodyId{3}));
}

TEST_F(Merged, ABodyUnderWayIsMarkedThoughItIsKnownWhereItIs) {
  Observation left = of(0, 5);
  add(left, 3, 1, 1, true);
  states_.accept(left, now_s_);
  states_.accept(of(1, 5), now_s_);
  states_.accept(made_up(1, 5, 3), now_s_);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_TRUE(taken[0].is_complete());
  ASSERT_EQ(taken[0].bodies.size(), 1U);
  EXPECT_TRUE(taken[0].bodies[0].under_way);
}

TEST_F(Merged, ABodyThatWasTakenOutOnItsWayIsNotWaitedFor) {
  Observation left = of(0, 5);
  add(left, 3, 1, 1, true);
  states_.accept(left, now_s_);
  states_.accept(of(1, 5), now_s_);
  Observation gone = of(1, 5);
  gone.kind = Observation::Kind::kMadeUp;
  gone.outside = {BodyId{3}};
  states_.accept(gone, now_s_);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_TRUE(taken[0].is_complete());
  EXPECT_THAT(taken[0].bodies, IsEmpty());
}

TEST_F(Merged, ARegionThatHasLeftAStateOutIsNamed) {
  both(5);
  states_.accept(of(0, 6), now_s_);
  both(7);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 3U);
  EXPECT_THAT(taken[1].silent, ElementsAre(RegionId{1}));
  EXPECT_FALSE(taken[1].is_complete());
}

TEST_F(Merged, BeforeTheFirstWholeStateNothingIsSaid) {
  states_.accept(of(0, 5), now_s_);
  states_.accept(of(0, 6), now_s_);
  both(7);
  EXPECT_THAT(steps(), ElementsAre(7));
}

TEST_F(Merged, TheFirstWholeStateIsWaitedForHoweverLateARegionHearsWhatIsWanted) {
  states_.accept(of(0, 5), now_s_);
  EXPECT_THAT(steps(), IsEmpty());
  now_s_ += 20;
  EXPECT_THAT(steps(), IsEmpty());
  states_.accept(of(1, 5), now_s_);
  EXPECT_THAT(steps(), ElementsAre(5)) << "the run stands: there will be no other";
}

TEST_F(Merged, AfterARedoStatesComeAgain) {
  for (core::Step step = 5; step <= 8; ++step) both(step);
  EXPECT_THAT(steps(), ElementsAre(5, 6, 7, 8));
  states_.accept(of(0, 9), now_s_);
  both(6, 1);
  states_.accept(of(1, 9), now_s_);
  EXPECT_THAT(steps(), ElementsAre(6)) << "9 was of the world before";
  both(7, 1);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].redo, 1U);
}

TEST_F(Merged, AnotherGenerationBeginsAnew) {
  both(50);
  EXPECT_THAT(steps(), ElementsAre(50));
  states_.accept(of(0, 0, 0, 3), now_s_);
  states_.accept(of(1, 51), now_s_);
  states_.accept(of(1, 0, 0, 3), now_s_);
  EXPECT_THAT(steps(), ElementsAre(0));
}

TEST_F(Merged, TheHighestEpochOwns) {
  Observation a = of(0, 5), b = of(1, 5);
  add(a, 3, 1, 4);
  add(b, 3, 1, 3);
  states_.accept(a, now_s_);
  states_.accept(b, now_s_);
  const std::vector<MergedState> taken = take();
  ASSERT_EQ(taken.size(), 1U);
  ASSERT_EQ(taken[0].bodies.size(), 1U);
  EXPECT_EQ(taken[0].bodies[0].row.epoch, 4U);
}

}  // namespace
}  // namespace aurasim::agent
