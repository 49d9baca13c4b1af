// In which state nodes stand after a pause, steps and a resume, whatever each has done before it hears of them.
#include "cli/hold.h"

#include <gtest/gtest.h>

namespace aurasim::cli {
namespace {

using core::Step;
using Kind = dds::RunCommandKind;

dds::RunCommand command(Kind kind, Step at_step, std::int64_t count = 0) {
  dds::RunCommand command;
  command.kind = kind;
  command.at_step = at_step;
  command.count = count;
  return command;
}

TEST(Hold, AStepGoesToTheStateThatItNames) {
  const dds::RunCommand step = command(Kind::kStep, 105, 5);
  EXPECT_EQ(holds_at_after(step, 100), 105);
  EXPECT_EQ(first_state_of(step), 101);
}

TEST(Hold, ANodeThatHasFollowedTheOthersBeforeItHearsOfAStepGoesNoFarther) {
  const dds::RunCommand step = command(Kind::kStep, 105, 5);
  for (const Step followed_to : {100, 103, 105}) EXPECT_EQ(holds_at_after(step, followed_to), 105) << followed_to;
}

TEST(Hold, TwoStepsAddUpWhereverANodeHearsOfThem) {
  const dds::RunCommand first = command(Kind::kStep, 105, 5), second = command(Kind::kStep, 108, 3);
  for (const Step followed_to : {100, 105, 108}) {
    EXPECT_EQ(holds_at_after(second, holds_at_after(first, followed_to)), 108) << followed_to;
  }
}

TEST(Hold, NobodyGoesBackForAStepThatComesLate) { EXPECT_EQ(holds_at_after(command(Kind::kStep, 105, 5), 110), 110); }

TEST(Hold, AStepSaysNothingToANodeThatRuns) {
  EXPECT_EQ(holds_at_after(command(Kind::kStep, 105, 5), std::nullopt), std::nullopt);
}

TEST(Hold, APauseNamesItsStateAndAResumeEndsIt) {
  EXPECT_EQ(holds_at_after(command(Kind::kPause, 105), std::nullopt), 105);
  EXPECT_EQ(holds_at_after(command(Kind::kPause, 105), 200), 105);
  EXPECT_EQ(holds_at_after(command(Kind::kResume, 105), 105), std::nullopt);
  EXPECT_EQ(holds_at_after(command(Kind::kStop, 300), 105), 105);
}

}  // namespace
}  // namespace aurasim::cli
