// The definitions of docs/design.md, "What is counted".
#include "lab/metrics.h"

#include <gtest/gtest.h>

namespace aurasim::lab {
namespace {

Contact contact(double penetration_m, double relative_speed_m_s, core::Step step = 10) {
  return {step, penetration_m, relative_speed_m_s};
}

Trial met(const Contact& c, core::Step central_step = 10) {
  Trial trial;
  trial.contact = c;
  trial.central_step = central_step;
  return trial;
}

TEST(Definitions, PenetrationTimeIsPenetrationOverRelativeSpeed) {
  EXPECT_DOUBLE_EQ(penetration_time_s(contact(0.5, 50)), 0.01);
  EXPECT_DOUBLE_EQ(penetration_time_s(contact(-0.02, 2)), -0.01) << "Bullet sees contacts within its margin";
}

TEST(Definitions, LateIsAboveOneStep) {
  EXPECT_FALSE(is_late(contact(kStep_s * 50, 50), kStep_s));
  EXPECT_TRUE(is_late(contact(kStep_s * 50 * 1.0001, 50), kStep_s));
  EXPECT_FALSE(is_late(contact(0, 0), kStep_s));
}

TEST(Definitions, MissedIsMetInOneWorldOnly) {
  EXPECT_TRUE(is_missed(std::nullopt, true));
  EXPECT_FALSE(is_missed(std::nullopt, false)) << "they never meet";
  EXPECT_FALSE(is_missed(contact(0.1, 1), true));
}

TEST(Definitions, ThrashedIsMoreThanOneHandOff) {
  EXPECT_FALSE(is_thrashed(0));
  EXPECT_FALSE(is_thrashed(1));
  EXPECT_TRUE(is_thrashed(2));
}

TEST(Definitions, AViolationThatTheContactItselfMadeIsNoWarning) {
  Trial trial = met(contact(2, 10));
  ASSERT_TRUE(trial.late());
  trial.flagged = true;
  EXPECT_TRUE(trial.late_without_violation());
  trial.violations = 1;
  EXPECT_FALSE(trial.late_without_violation());
  trial.flagged = false;
  EXPECT_TRUE(trial.late_without_violation()) << "some node counted a violation, but the one that saw it did not know";
}

TEST(Tally, CountsOnlyPairsThatMeetInOneWorld) {
  Tally tally;
  Trial apart;
  apart.hand_offs = 5;
  tally.add(apart);
  EXPECT_EQ(tally.trials, 0u);
  EXPECT_EQ(tally.thrashed, 0u);
}

TEST(Tally, AddsUp) {
  Tally tally;
  tally.add(met(contact(0.1, 32)));
  Trial late = met(contact(2, 32, 12));
  late.hand_offs = 2;
  late.slow_down = 1.5;
  tally.add(late);
  Trial missed;
  missed.central_step = 10;
  tally.add(missed);
  Tally total;
  total.add(tally);
  total.add(tally);
  EXPECT_EQ(total.trials, 6u);
  EXPECT_EQ(total.late, 2u);
  EXPECT_EQ(total.later_than_central, 2u);
  EXPECT_EQ(total.missed, 2u);
  EXPECT_EQ(total.missed_without_violation, 2u);
  EXPECT_EQ(total.thrashed, 2u);
  EXPECT_DOUBLE_EQ(total.mean_slow_down(), 3.5 / 3);
  EXPECT_DOUBLE_EQ(total.penetration_time_most_s, 2.0 / 32);
}

}  // namespace
}  // namespace aurasim::lab
