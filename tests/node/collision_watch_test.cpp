// The judge of correctness, told by hand what one node sees: is each rule held, and nothing called wrong that is right?
#include "node/collision_watch.h"

#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "core/horizon.h"
#include "node/collision_watch_fixture.h"

namespace aurasim::node {
namespace {

using core::BodyId;
using core::PrototypeId;
using core::Step;
using core::Vec3;
using core::testing::aura;
using core::testing::batch;
using core::testing::body;
using core::testing::record_of;
using core::testing::region;

constexpr double kSlop_m = 0.02;

using FirstContact = CollisionWatchTest;

TEST_F(FirstContact, IsLateIfTheTwoAreDeeperInEachOtherThanTheyMoveInOneStep) {
  pass(10);
  const double one_step_m = 6 * kStep_s + kGravity_m_s2 * kStep_s * kStep_s + kSlop_m;
  EXPECT_FALSE(touch(1, 2, one_step_m - 1e-6, 6).late);
  EXPECT_EQ(watch_.late(), 0u);
  join({3});
  EXPECT_TRUE(touch(3, 4, one_step_m + 1e-6, 6).late);
  EXPECT_EQ(watch_.late(), 1u);
  EXPECT_EQ(watch_.missed(), 0u);
}

/// A joint that breaks, a wall that is put among them: it is as deep in one world.
TEST_F(FirstContact, OfTwoThatHaveLongBeenHereIsNotLateHoweverDeep) {
  pass(10);
  EXPECT_FALSE(touch(1, 2, 0.4, 0).late);
  join({3});
  judge_arrivals();
  pass(1);
  judge_arrivals();
  pass(1);
  EXPECT_FALSE(touch(1, 3, 0.4, 0).late);
  join({5, 6});
  EXPECT_FALSE(touch(5, 6, 0.4, 0).late) << "they came together";
  EXPECT_TRUE(touch(1, 5, 0.4, 0).late);
}

TEST_F(FirstContact, BeforeTheShapesOverlapIsNotLate) {
  pass(10);
  EXPECT_FALSE(touch(1, 2, -0.01, 0).late);
}

TEST_F(FirstContact, InTheFirstTwoStatesIsTheScenesDoing) {
  pass(2);
  join({2});
  EXPECT_FALSE(touch(1, 2, 0.4, 0).late);
  pass(1);
  join({4});
  EXPECT_TRUE(touch(3, 4, 0.4, 0).late);
}

TEST_F(FirstContact, OfABodyThatIsBornInAnotherIsTheScenesDoing) {
  watch_.newborn(body(7), 20);
  go_to(22);
  join({1});
  EXPECT_FALSE(touch(1, 7, 0.4, 0).late);
  EXPECT_FALSE(touch(7, 9, 0.4, 0).late);
  EXPECT_TRUE(touch(1, 9, 0.4, 0).late) << "the others are not young";
  go_to(23);
  EXPECT_TRUE(touch(1, 7, 0.4, 0).late) << "nor is it any more";
}

TEST_F(FirstContact, OfABodyThatWasBornElsewhereAMomentAgoIsTheScenesDoing) {
  go_to(21);
  join({7}, 1, 20, 20);
  EXPECT_FALSE(touch(1, 7, 0.4, 0).late);
  judge_arrivals();
  go_to(23);
  EXPECT_TRUE(touch(1, 7, 0.4, 0).late);
}

TEST_F(FirstContact, OfABodyOfTheSceneThatComesLaterIsJudged) {
  go_to(21);
  join({7}, 1, 20);
  judge_arrivals();
  EXPECT_TRUE(touch(1, 7, 0.4, 0).late);
}

using Flag = CollisionWatchTest;

TEST_F(Flag, ABrokenPromiseExplainsWhatIsWrongUntilItsMessagesAreReplaced) {
  last_violation_ = 10;
  go_to(10 + core::horizon::blame(kLookahead));
  join({1, 3});
  EXPECT_TRUE(touch(1, 2, 0.4, 0).flagged);
  EXPECT_EQ(watch_.unflagged(), 0u);
  pass(1);
  EXPECT_FALSE(touch(3, 4, 0.4, 0).flagged);
  EXPECT_EQ(watch_.unflagged(), 1u);
  EXPECT_EQ(watch_.late(), 2u);
}

TEST_F(Flag, WhatIsNotWrongNeedsNoExplanation) {
  pass(10);
  EXPECT_FALSE(touch(1, 2, 0.01, 1).late);
  EXPECT_EQ(watch_.unflagged(), 0u);
}

/// Two balls of ours that overlap by 0.4 m and stand still.
class Arrival : public CollisionWatchTest {
 protected:
  Arrival() {
    pass(9);
    place(1, Vec3(-20, 0, 0)).awake = false;
    place(2, Vec3(-20.6, 0, 0)).awake = false;
    pass(1);
  }
};

TEST_F(Arrival, ThatOverlapsASleeperIsLateAtOnce) {
  join({2});
  ASSERT_EQ(judge_arrivals().size(), 1u);
  EXPECT_TRUE(seen_[0].late);
  EXPECT_EQ(seen_[0].collision.a, body(1));
  EXPECT_EQ(seen_[0].collision.b, body(2));
  EXPECT_EQ(seen_[0].collision.step, 10);
  EXPECT_NEAR(seen_[0].collision.penetration_m, 0.4, 1e-9);
  EXPECT_EQ(watch_.late(), 1u);
}

TEST_F(Arrival, ThatWasJudgedIsNotJudgedAgainWhenTheTwoTouch) {
  join({2});
  judge_arrivals();
  pass(5);
  EXPECT_TRUE(judge_arrivals().empty());
  EXPECT_FALSE(touch(1, 2, 0.4, 0).late);
  EXPECT_EQ(watch_.late(), 1u);
}

TEST_F(Arrival, OfBothFromOneWorldHasBeenJudgedThere) {
  join({1, 2});
  EXPECT_TRUE(judge_arrivals().empty());
  pass(5);
  EXPECT_FALSE(touch(1, 2, 0.4, 0).late) << "nor is their contact here";
  EXPECT_EQ(watch_.late(), 0u);
}

TEST_F(Arrival, OfBothFromTwoWorldsIsJudgedOnce) {
  join({1}, 1);
  join({2}, 2);
  EXPECT_EQ(judge_arrivals().size(), 1u);
}

TEST_F(Arrival, OfBothFromOneWorldAtTwoTimesIsJudged) {
  join({1}, 1, 7);
  join({2}, 1, 8);
  EXPECT_EQ(judge_arrivals().size(), 1u);
}

TEST_F(Arrival, ThatMovesIsLeftToPhysics) {
  state_of(2).v_WB = Vec3(0, 0, 0.001);
  state_of(2).awake = true;
  pass(1);
  join({2});
  EXPECT_TRUE(judge_arrivals().empty());
  EXPECT_TRUE(touch(1, 2, 0.4, 0).late) << "which finds the contact in the next step";
}

TEST_F(Arrival, ThatTouchesWhatItOverlapsIsLeftToPhysics) {
  snapshot_.contacts = {{0, 1}};
  pass(1);
  join({2});
  EXPECT_TRUE(judge_arrivals().empty());
}

TEST_F(Arrival, ThatOnlyTouchesTheOtherIsRight) {
  state_of(2).pose.p_WB.x() = -20.99;
  pass(1);
  join({2});
  EXPECT_TRUE(judge_arrivals().empty());
}

TEST_F(Arrival, ThatIsBornThereIsTheScenesDoing) {
  join({2}, 1, 9, 9);
  EXPECT_TRUE(judge_arrivals().empty());
}

TEST_F(Arrival, ThatLeftAndComesAgainIsJudgedAgain) {
  join({2});
  judge_arrivals();
  const core::BodyState gone = state_of(2);
  take_away(2);
  pass(1);
  judge_arrivals();
  snapshot_.bodies.push_back(gone);
  pass(1);
  join({2}, 1, 11);
  EXPECT_EQ(judge_arrivals().size(), 1u);
  EXPECT_EQ(watch_.late(), 2u);
}

TEST_F(Arrival, ThatHasLeftInTheSameStateIsNotJudged) {
  join({2});
  take_away(2);
  pass(1);
  EXPECT_TRUE(judge_arrivals().empty());
}

/// One ball of ours, and beside it one of region 1; each state is compared.
class Missed : public CollisionWatchTest {
 protected:
  Missed() {
    pass(9);
    place(1, kOurs);
    next({foreign(50, kBeside)});
  }
  /// One more state, for which region 1 says where its ball was in the state before.
  const std::vector<SeenCollision>& next(const std::vector<core::AuraRecord>& said) {
    go_to(now_ + 1, said);
    return compare();
  }

  const Vec3 kOurs = Vec3(-1, 0, 0);
  const Vec3 kBeside = Vec3(0.02, 0, 0);
};

TEST_F(Missed, IsWhoOverlapsABodyOfAnotherHostInTheSameState) {
  ASSERT_EQ(next({foreign(50, Vec3(-0.3, 0, 0), Vec3(-4, 0, 0))}).size(), 1u);
  EXPECT_TRUE(seen_[0].missed);
  EXPECT_FALSE(seen_[0].late);
  EXPECT_EQ(seen_[0].collision.step, 10) << "the state of the aura";
  EXPECT_EQ(seen_[0].collision.a, body(1));
  EXPECT_EQ(seen_[0].collision.b, body(50));
  EXPECT_NEAR(seen_[0].collision.penetration_m, 0.3, 1e-9);
  EXPECT_NEAR(seen_[0].collision.relative_speed_m_s, 4, 1e-9);
  EXPECT_EQ(watch_.missed(), 1u);
}

TEST_F(Missed, IsNobodyWhoOnlyTouches) { EXPECT_TRUE(next({foreign(50, Vec3(-0.01, 0, 0))}).empty()); }

TEST_F(Missed, IsNobodyWhoIsNear) { EXPECT_TRUE(next({foreign(50, Vec3(0.1, 0, 0))}).empty()); }

TEST_F(Missed, IsJudgedByWhereOursWasThen) {
  state_of(1).pose.p_WB = Vec3(-1.52, 0, 0);
  EXPECT_EQ(next({foreign(50, Vec3(-0.5, 0, 0))}).size(), 1u) << "in state 10 they overlapped";
}

TEST_F(Missed, IsNotJudgedByWhereOursIsNow) {
  state_of(1).pose.p_WB = Vec3(-0.4, 0, 0);
  EXPECT_TRUE(next({foreign(50, Vec3(0.5, 0, 0))}).empty()) << "in state 10 they did not";
}

TEST_F(Missed, IsCountedOnceForAsLongAsTheTwoOverlap) {
  for (int i = 0; i < 20; ++i) next({foreign(50, Vec3(-0.5, 0, 0))});
  EXPECT_EQ(watch_.missed(), 1u);
}

TEST_F(Missed, IsCountedAgainWhenTheTwoHavePartedAndMeetAgain) {
  next({foreign(50, Vec3(-0.5, 0, 0))});
  for (int i = 0; i < 20; ++i) next({foreign(50, kBeside)});
  next({foreign(50, Vec3(-0.5, 0, 0))});
  EXPECT_EQ(watch_.missed(), 2u);
}

TEST_F(Missed, IsNoGhost) {
  core::AuraRecord ghost = foreign(50, Vec3(-0.5, 0, 0));
  ghost.flags |= core::kAuraGhost;
  EXPECT_TRUE(next({ghost}).empty());
}

TEST_F(Missed, IsNobodyBeforeBirth) {
  core::AuraRecord unborn = foreign(50, Vec3(-0.5, 0, 0));
  unborn.birth = 40;
  EXPECT_TRUE(next({unborn}).empty());
}

TEST_F(Missed, IsNoneOfOursBeforeBirth) {
  place(2, Vec3(-20, 0, 0)).birth = 40;
  next({foreign(51, Vec3(-20.5, 0, 0))});
  EXPECT_TRUE(next({foreign(51, Vec3(-20.5, 0, 0))}).empty());
}

TEST_F(Missed, IsNobodyWhoHasComeHere) {
  place(50, Vec3(-0.5, 0, 0));
  EXPECT_TRUE(next({foreign(50, Vec3(-0.5, 0, 0))}).empty());
}

TEST_F(Missed, NeedsABrokenPromiseToExplainIt) {
  next({foreign(50, Vec3(-0.5, 0, 0))});
  EXPECT_EQ(watch_.unflagged(), 1u);
  place(2, Vec3(-20, 0, 0));
  next({foreign(51, Vec3(-19, 0, 0))});
  last_violation_ = now_;
  ASSERT_EQ(next({foreign(51, Vec3(-19.5, 0, 0))}).size(), 1u);
  EXPECT_TRUE(seen_[0].flagged);
  EXPECT_EQ(watch_.unflagged(), 1u);
}

}  // namespace
}  // namespace aurasim::node
