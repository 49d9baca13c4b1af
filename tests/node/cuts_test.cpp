// Which states a node keeps, for how long, and to which of them a redo goes back.
#include "node/cuts.h"

#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/horizon.h"

namespace aurasim::node {
namespace {

using core::BodyId;
using core::Step;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kLookahead = 2;
constexpr Step kEvery = core::horizon::kBetweenOlderCuts;

Cut cut_of(Step step) { return {step, {}, {}, {}, {}}; }

core::Adoption sent_in(Step stamp) {
  core::Adoption adoption;
  adoption.stamp = stamp;
  return adoption;
}

core::Alarm alarm(Step step, std::uint64_t a = 1, std::uint64_t b = 2) { return {0, step, BodyId{a}, BodyId{b}}; }

class CutsOfANode : public ::testing::Test {
 protected:
  CutsOfANode() {
    for (Step step = 0; step <= 300; step += kEvery) cuts_.keep(cut_of(step));
  }
  core::Redo plan(std::vector<core::Alarm> alarms, std::vector<core::TogetherPair> together = {}) {
    return cuts_.plan(alarms, std::move(together));
  }

  Cuts cuts_{kLookahead};
};

TEST_F(CutsOfANode, ARedoGoesBackFarEnoughToBringThePairTogether) {
  const Step touch = 200;
  const core::Redo redo = plan({alarm(touch)});
  EXPECT_LE(redo.cut, touch - core::horizon::kBeforeTouch);
  EXPECT_GT(redo.cut + kEvery, touch - core::horizon::kBeforeTouch) << "and no farther";
  ASSERT_EQ(redo.pairs.size(), 1U);
  EXPECT_GE(redo.pairs[0].until, touch);
}

/// Its memory comes from a cut of a state in which all bodies had changed.
TEST_F(CutsOfANode, ACutOfFewChangesTakesLittleMemory) {
  Cut cut = cut_of(310);
  cut.bodies.now.bodies.reserve(100'000);
  cut.bodies.now.points.reserve(100'000);
  cut.bodies.now.bodies.resize(3);
  cuts_.keep(std::move(cut));
  const core::ClusterState& kept = cuts_.back_to(310).bodies.now;
  EXPECT_EQ(kept.bodies.size(), 3);
  EXPECT_LT(kept.bodies.capacity() + kept.points.capacity(), 100);
}

TEST_F(CutsOfANode, TheEarliestAlarmDecidesAndAllPairsAreNamedInOrder) {
  const core::Redo redo = plan({alarm(250, 7, 8), alarm(150, 3, 4)});
  EXPECT_EQ(redo.cut, plan({alarm(150)}).cut);
  ASSERT_EQ(redo.pairs.size(), 2U);
  EXPECT_EQ(redo.pairs[0].a, BodyId{3});
}

TEST_F(CutsOfANode, APairThatARedoHasNotBroughtTogetherGoesBackFartherEachTime) {
  std::vector<core::TogetherPair> together;
  std::vector<Step> back;
  const Step touch = 270 + core::horizon::kBeforeTouch;
  for (int i = 0; i < 8; ++i) {
    const core::Redo redo = plan({alarm(touch)}, together);
    together = redo.pairs;
    back.push_back(redo.cut);
  }
  EXPECT_EQ(back[0], 270) << "they gather there";
  EXPECT_LE(back[1], touch - core::horizon::before_pull(kLookahead)) << "one pulls the other one";
  for (int i = 1; i <= 5; ++i) EXPECT_EQ(back[i], back[i - 1] - kEvery);
  EXPECT_EQ(back[7], back[5]) << "four older cuts at most";
}

TEST_F(CutsOfANode, AnAlarmAboutAStaticNamesNoPair) {
  const core::Redo redo = plan({{0, 200, core::kNobody, core::kNobodyElse}});
  EXPECT_THAT(redo.pairs, IsEmpty());
  EXPECT_EQ(redo.cut, plan({alarm(200)}).cut);
}

TEST_F(CutsOfANode, PairsWhoseTimeIsOverAreNotNamedAnyMore) {
  const core::Redo redo = plan({alarm(280)}, {{BodyId{5}, BodyId{6}, 10}});
  ASSERT_EQ(redo.pairs.size(), 1U);
  EXPECT_EQ(redo.pairs[0].a, BodyId{1});
}

TEST_F(CutsOfANode, WhatARedoMayStillNeedIsNotForgotten) {
  const Step needed = plan({alarm(201)}).cut;
  cuts_.forget(200, false);
  EXPECT_EQ(cuts_.oldest(), needed - 4 * kEvery) << "four older ones for a pair that stays apart";
  cuts_.forget(100'000, false);
  EXPECT_EQ(cuts_.oldest(), 300 - 4 * kEvery);
}

TEST_F(CutsOfANode, OfTheOnesBeforeAConfirmedStateOnlyAFewAreKept) {
  Cuts cuts(kLookahead);
  for (Step step = 0; step <= 300; step += core::horizon::kBetweenCuts) {
    cuts.keep(cut_of(step));
    cuts.forget(step - 20, false);
  }
  std::vector<Step> kept;
  for (Step step = 300; step >= 0; --step) {
    try {
      kept.push_back(cuts.back_to(step).step);
    } catch (const std::logic_error&) {
    }
  }
  // For a touch in the first state that is not confirmed, and for one in the state after the cut of that.
  const auto cut_before = [](Step touch) {
    const Step wanted = touch - core::horizon::before_pull(kLookahead);
    return wanted - wanted % core::horizon::kBetweenCuts;
  };
  const Step needed = cut_before(cut_before(300 - 20 + 1) + 1);
  std::vector<Step> expected;
  for (Step step = 300; step >= needed; step -= core::horizon::kBetweenCuts) expected.push_back(step);
  for (int i = 0; i < 4; ++i) {
    Step step = (expected.back() - 1) / kEvery * kEvery;
    expected.push_back(step);
  }
  EXPECT_EQ(kept, expected);
}

TEST_F(CutsOfANode, TheMemoryOfADroppedOneIsUsedAgain) {
  EXPECT_EQ(cuts_.take_memory().now.bodies.capacity(), 0U);
  Cut large = cut_of(330);
  large.bodies.now.bodies.resize(100);
  cuts_.keep(std::move(large));
  cuts_.back_to(300);
  EXPECT_GE(cuts_.take_memory().now.bodies.capacity(), 100U);
}

TEST_F(CutsOfANode, AnAlarmThatStandsForEverDoesNotKeepThemAll) {
  for (Step step = 330; step <= 3000; step += kEvery) {
    cuts_.keep(cut_of(step));
    cuts_.forget(0, true);
  }
  EXPECT_GT(cuts_.oldest(), 3000 - 90 * kEvery);
}

TEST_F(CutsOfANode, GoingBackDropsLaterOnesAndKnowsWhichItHas) {
  EXPECT_EQ(cuts_.back_to(120).step, 120);
  EXPECT_THROW(cuts_.back_to(150), std::logic_error) << "dropped";
  EXPECT_THROW(cuts_.back_to(119), std::logic_error);
}

TEST_F(CutsOfANode, AClusterBelongsToTheCutsThatItWasSentBefore) {
  cuts_.note_arrival(sent_in(100));
  cuts_.note_spawn({});
  EXPECT_EQ(cuts_.back_to(120).joining.size(), 1U);
  EXPECT_EQ(cuts_.back_to(120).to_be_born.spawns.size(), 1U);
  EXPECT_EQ(cuts_.back_to(90).joining.size(), 0U);
  EXPECT_EQ(cuts_.back_to(90).to_be_born.spawns.size(), 1U) << "an order holds, whenever it was received";
}

class SavedStatesOfANode : public ::testing::Test {
 protected:
  void compute(Step step) {
    saved_.take(step, [&] { return cut_of(step); });
  }
  std::vector<Step> take_whole(Step confirmed) {
    std::vector<Step> steps;
    for (const Cut& cut : saved_.take_whole(confirmed)) steps.push_back(cut.step);
    return steps;
  }
  static bool always(Step) { return true; }

  SavedStates saved_;
};

TEST_F(SavedStatesOfANode, APartIsReadyOnceItsStateIsConfirmedAndAllHasArrived) {
  saved_.ask(10);
  compute(9);
  compute(10);
  EXPECT_THAT(take_whole(20), IsEmpty()) << "clusters may be under way";
  saved_.note_whole(always);
  EXPECT_THAT(take_whole(9), IsEmpty()) << "not confirmed";
  EXPECT_THAT(take_whole(10), ElementsAre(10));
  EXPECT_THAT(take_whole(10), IsEmpty()) << "once";
}

TEST_F(SavedStatesOfANode, TheRunGoesBackToBeforeItAndComputesItAgain) {
  saved_.ask(10);
  compute(10);
  saved_.note_whole(always);
  saved_.put_back(9, 0);
  saved_.note_whole(always);
  EXPECT_THAT(take_whole(20), IsEmpty());
  compute(10);
  saved_.note_whole(always);
  EXPECT_THAT(take_whole(20), ElementsAre(10));
}

/// Every node gives out the same part of the world: all as it was, or all as it is computed again.
TEST_F(SavedStatesOfANode, AConfirmedStateStaysAsItWas) {
  saved_.ask(10);
  saved_.ask(12);
  compute(10);
  compute(12);
  saved_.note_whole(always);
  saved_.put_back(9, 10);
  EXPECT_THAT(take_whole(5), ElementsAre(10)) << "whatever is confirmed after the redo";
  saved_.note_whole(always);
  EXPECT_THAT(take_whole(20), IsEmpty()) << "12 is to be computed again";
}

TEST_F(SavedStatesOfANode, WhatWasUnderWayIsPartOfIt) {
  saved_.ask(10);
  saved_.note_arrival(sent_in(8));
  compute(10);
  saved_.note_arrival(sent_in(10));
  saved_.note_arrival(sent_in(11));
  saved_.note_whole(always);
  const std::vector<Cut> whole = saved_.take_whole(10);
  ASSERT_EQ(whole.size(), 1U);
  ASSERT_EQ(whole[0].joining.size(), 1U) << "the first had joined before, the last left later";
  EXPECT_EQ(whole[0].joining[0].stamp, 10);
}

TEST_F(SavedStatesOfANode, TheEarliestEndCountsAndIsNotHandedOut) {
  saved_.end_with(20);
  saved_.end_with(15);
  saved_.end_with(30);
  EXPECT_EQ(saved_.end(), 15);
  EXPECT_EQ(saved_.end_cut(15), nullptr) << "not computed yet";
  compute(15);
  saved_.note_whole(always);
  EXPECT_THAT(take_whole(40), IsEmpty());
  ASSERT_NE(saved_.end_cut(15), nullptr);
  EXPECT_EQ(saved_.end_cut(20), nullptr);
  saved_.forget_end();
  EXPECT_FALSE(saved_.end());
}

}  // namespace
}  // namespace aurasim::node
