// In which state nodes stand after steps, in whatever order each has heard of them.
#include "process/hold.h"

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using core::Step;
using namespace std::chrono_literals;

/// Of a client that knows state `from`.
messages::RunCommand step(std::uint64_t request, Step from, std::int64_t count, core::Generation generation = 1) {
  messages::RunCommand command;
  command.kind = messages::RunCommandKind::kStep;
  command.request = request;
  command.generation = generation;
  command.at_step = from + count;
  command.count = count;
  return command;
}

Step end_of(Step paused_at, const std::vector<messages::RunCommand>& steps) {
  AskedSteps asked;
  asked.begin(paused_at);
  for (const messages::RunCommand& one : steps) asked.add(one);
  return asked.end();
}

TEST(AskedSteps, LeadToTheStateThatTheyName) {
  EXPECT_EQ(end_of(100, {step(1, 100, 5)}), 105);
  EXPECT_EQ(end_of(100, {step(1, 100, 5), step(2, 105, 3)}), 108);
}

TEST(AskedSteps, AddUpAlsoFromOneState) {
  EXPECT_EQ(end_of(100, {step(1, 100, 5), step(2, 100, 5)}), 110);
  EXPECT_EQ(end_of(100, {step(1, 100, 5), step(2, 100, 5), step(3, 105, 5)}), 115) << "it had seen one of the two";
}

TEST(AskedSteps, ThatComeTwiceCountOnce) {
  EXPECT_EQ(end_of(100, {step(1, 100, 5), step(2, 100, 1), step(1, 100, 5)}), 106);
}

TEST(AskedSteps, OfWhoKnewALaterStateThanThePauseNamedGoOnFromThere) {
  EXPECT_EQ(end_of(100, {step(1, 103, 5)}), 108) << "nodes that were farther have made the others follow";
}

TEST(AskedSteps, BeginAnewWithAPause) {
  AskedSteps asked;
  asked.begin(100);
  asked.add(step(1, 100, 100'000));
  asked.begin(300);
  asked.add(step(2, 300, 5));
  EXPECT_EQ(asked.end(), 305) << "the pause has ended the long step";
}

TEST(AskedSteps, OfAnotherGenerationBeginAnew) {
  EXPECT_EQ(end_of(600, {step(1, 600, 60), step(2, 540, 5, 2)}), 545) << "the run has gone back between the two";
}

TEST(AskedSteps, AddUpWhenThereAreMoreThanAreKept) {
  AskedSteps asked;
  asked.begin(0);
  for (std::uint64_t i = 0; i < 10'000; ++i) asked.add(step(i + 1, static_cast<Step>(i), 2));
  EXPECT_EQ(asked.end(), 20'000);
}

/// Two clients take turns as they like; each knows some state in which the run has stood.
TEST(AskedSteps, LeadAllNodesToOneStateInWhateverOrderTheyHear) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    std::vector<messages::RunCommand> steps;
    Step known = 100, sum = 100;
    for (std::uint64_t request = 1; request <= 20; ++request) {
      const auto count = static_cast<std::int64_t>(1 + random() % 9);
      steps.push_back(step(request, known, count));
      sum += count;
      if (random() % 3 != 0) known = sum - static_cast<Step>(random() % 2) * count;
    }
    for (int node = 0; node < 5; ++node) {
      std::ranges::shuffle(steps, random);
      EXPECT_EQ(end_of(100, steps), sum) << "seed " << seed;
    }
  }
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
    messages::RunCommand command = step(1, 100, 5);
    command.after = {program, number};
    words_.add(command, now_);
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

TEST(FarthestPause, IsThatOfLiveNodesOfThisGeneration) {
  std::map<core::RegionId, messages::SeenStatus> nodes;
  EXPECT_EQ(farthest_pause(nodes, 2), 0);
  for (std::uint32_t region = 0; region < 4; ++region) {
    nodes[core::RegionId{region}].status.state = messages::NodeState::kPaused;
    nodes[core::RegionId{region}].status.generation = 2;
    nodes[core::RegionId{region}].status.step = 100 + region;
  }
  EXPECT_EQ(farthest_pause(nodes, 2), 103);
  nodes[core::RegionId{3}].lost = true;
  nodes[core::RegionId{2}].status.state = messages::NodeState::kRunning;
  nodes[core::RegionId{1}].status.generation = 1;
  EXPECT_EQ(farthest_pause(nodes, 2), 100);
}

}  // namespace
}  // namespace aurasim::process
