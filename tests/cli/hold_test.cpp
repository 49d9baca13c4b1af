// In which state nodes stand after a pause, steps and a resume, whatever each has done before it hears of them.
#include "cli/hold.h"

#include <map>
#include <vector>

#include <gtest/gtest.h>

namespace aurasim::cli {
namespace {

using core::Step;
using namespace std::chrono_literals;
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

class PauseFollowing : public ::testing::Test {
 protected:
  Step stands_in(Step holds_at, Step farthest) { return follower_.holds_at(holds_at, farthest, now_); }
  void pass(std::chrono::milliseconds time) { now_ += time; }

 private:
  PauseFollower follower_;
  PauseFollower::Time now_{std::chrono::seconds(5)};
};

TEST_F(PauseFollowing, ANodeComesToWhereAnotherStands) {
  EXPECT_EQ(stands_in(100, 100), 100);
  stands_in(100, 104);
  pass(1s);
  EXPECT_EQ(stands_in(100, 104), 104);
}

TEST_F(PauseFollowing, ANodeDoesNotFollowAStepThatItIsAboutToHearOf) {
  for (Step step = 100; step < 200; ++step) {
    EXPECT_EQ(stands_in(step, step + 1), step) << "the others have heard of it a moment ago";
    pass(20ms);
    EXPECT_EQ(stands_in(step + 1, step + 1), step + 1);
  }
}

class Awaited : public ::testing::Test {
 protected:
  void step_after(std::uint64_t program, std::uint64_t number) {
    dds::RunCommand step = command(Kind::kStep, 105, 5);
    step.after = {program, number};
    words_.add(step, now_);
  }
  void hear(std::uint64_t program, std::uint64_t number) { heard_[program] = number; }
  bool goes_on() {
    return words_.are_here(
        [this](const core::ProgramWord& word) {
          return heard_.contains(word.program) && heard_[word.program] >= word.number;
        },
        now_);
  }
  void pass(std::chrono::milliseconds time) { now_ += time; }

  AwaitedWords words_;

 private:
  std::map<std::uint64_t, std::uint64_t> heard_;
  AwaitedWords::Time now_{std::chrono::seconds(5)};
};

TEST_F(Awaited, AStepThatNamesNoWordIsNotHeldUp) {
  step_after(7, 0);
  EXPECT_TRUE(goes_on());
}

TEST_F(Awaited, AStepWaitsForTheWordThatItNames) {
  hear(7, 11);
  step_after(7, 12);
  EXPECT_FALSE(goes_on());
  hear(8, 40);
  EXPECT_FALSE(goes_on()) << "another program's";
  hear(7, 13);
  EXPECT_TRUE(goes_on()) << "words come in order: a later one is as good";
  EXPECT_TRUE(words_.take_given_up().empty());
}

TEST_F(Awaited, StepsOfTwoProgramsWaitForBoth) {
  step_after(7, 1), step_after(8, 1);
  hear(7, 1);
  EXPECT_FALSE(goes_on());
  hear(8, 1);
  EXPECT_TRUE(goes_on());
}

TEST_F(Awaited, AWordThatNeverComesIsGivenUpAndTold) {
  step_after(7, 12);
  pass(900ms);
  EXPECT_FALSE(goes_on());
  pass(200ms);
  EXPECT_TRUE(goes_on());
  EXPECT_EQ(words_.take_given_up(), (std::vector<core::ProgramWord>{{7, 12}}));
  EXPECT_TRUE(words_.take_given_up().empty()) << "once";
}

TEST_F(Awaited, ANewWorldWaitsForNothingThatWasSaidToTheOneBefore) {
  step_after(7, 12);
  words_.clear();
  EXPECT_TRUE(goes_on());
}

}  // namespace
}  // namespace aurasim::cli
