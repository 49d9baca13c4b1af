// Statics that are sent somewhere: by orders, and by what is expected of programs until its order is here.
#include "core/static_moves.h"

#include <gtest/gtest.h>

#include "core/limits.h"

namespace aurasim::core {
namespace {

constexpr double kStep_s = 1.0 / 60;
constexpr StaticId kLift{3};

Pose up(double z) { return {Vec3(0, 0, z), Quat::Identity()}; }

MoveStatic move_to(double from, double to, Step states = 1) { return {kLift, up(from), up(to), states}; }

double height(const StaticMoves& moves, Step step) { return moves.pose(StaticBody{}, kLift, step, kStep_s).p_WB.z(); }

TEST(StaticMoves, WhatIsExpectedCountsUntilItsOrderIsHere) {
  StaticMoves moves;
  moves.expect(move_to(0, 1), 10, 77);
  EXPECT_EQ(height(moves, 9), 0);
  EXPECT_EQ(height(moves, 10), 1);
  EXPECT_EQ(height(moves.ordered(kLift), 10), 0);
  EXPECT_EQ(moves.add(move_to(0, 1), 10, 77), std::nullopt) << "it is as it was expected";
  EXPECT_EQ(height(moves.ordered(kLift), 10), 1);
  EXPECT_EQ(moves.give_up_expected(1000), std::nullopt);
}

TEST(StaticMoves, AnOrderThatSaysSomethingElseTellsFromWhenOn) {
  StaticMoves moves;
  moves.expect(move_to(0, 1), 10, 77);
  EXPECT_EQ(moves.add(move_to(0, 1), 12, 77), 10) << "the order is later than what was expected";
  EXPECT_EQ(height(moves, 11), 0);
  moves.expect(move_to(1, 2), 20, 78);
  EXPECT_EQ(moves.add(move_to(1.5, 2), 20, 78), 20) << "from elsewhere";
  moves.expect(move_to(2, 3), 30, 79);
  EXPECT_EQ(moves.add(move_to(2, 3, 4), 30, 79), 30) << "more slowly";
  EXPECT_EQ(moves.add(move_to(3, 4), 40, 80), 40) << "nobody expected it";
}

TEST(StaticMoves, WhatIsNeverOrderedIsGivenUp) {
  StaticMoves moves;
  moves.expect(move_to(0, 1), 10, 77);
  moves.expect(move_to(1, 2), 20, 78);
  EXPECT_EQ(moves.give_up_expected(10), std::nullopt);
  EXPECT_EQ(moves.give_up_expected(11), 10);
  EXPECT_EQ(height(moves, 15), 0);
  EXPECT_EQ(height(moves, 20), 2);
}

TEST(StaticMoves, AWordThatComesAfterItsOrderIsNothingNew) {
  StaticMoves moves;
  moves.add(move_to(0, 5), 10, 77);
  moves.expect(move_to(0, 1), 9, 77);
  EXPECT_EQ(height(moves, 9), 0);
  EXPECT_EQ(moves.newest(kLift), 10);
}

TEST(StaticMoves, APlanBeginsWhereTheStaticIsByThenAndIsNoFasterThanMayBe) {
  StaticMoves moves;
  moves.add(move_to(0, 1, 10), 10, 1);
  const PlannedMove on = planned({kLift, up(2), 1}, 15, moves, StaticBody{}, kStep_s);
  EXPECT_EQ(on.at_step, 15);
  EXPECT_NEAR(on.move.from.p_WB.z(), 0.5, 1e-12);
  EXPECT_EQ(planned({kLift, up(2), 1}, 5, moves, StaticBody{}, kStep_s).at_step, 10) << "no earlier than the newest";
  const double far_m = 100 * limits::kFastestStatic_m_s * kStep_s;
  EXPECT_EQ(planned({kLift, up(1 + far_m), 1}, 50, moves, StaticBody{}, kStep_s).move.states, 100);
}

TEST(StaticMoves, ForgetsWhatLaterMovesHaveReplaced) {
  StaticMoves moves;
  for (Step step = 1; step <= 100; ++step) {
    moves.expect(move_to(static_cast<double>(step - 1), static_cast<double>(step)), step,
                 static_cast<std::uint64_t>(step));
  }
  moves.forget_before(90);
  EXPECT_EQ(height(moves, 90), 90);
  EXPECT_EQ(moves.give_up_expected(95), 90);
  EXPECT_EQ(height(moves, 94), 0);
}

}  // namespace
}  // namespace aurasim::core
