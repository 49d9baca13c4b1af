// In which state nodes stand after steps, in whatever order each has heard of them.
#include "cli/hold.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace aurasim::cli {
namespace {

using core::Step;

/// Of a client that knows state `from`.
dds::RunCommand step(std::uint64_t request, Step from, std::int64_t count, core::Generation generation = 1) {
  dds::RunCommand command;
  command.kind = dds::RunCommandKind::kStep;
  command.request = request;
  command.generation = generation;
  command.at_step = from + count;
  command.count = count;
  return command;
}

Step end_of(Step paused_at, const std::vector<dds::RunCommand>& steps) {
  AskedSteps asked;
  asked.begin(paused_at);
  for (const dds::RunCommand& one : steps) asked.add(one);
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
    std::vector<dds::RunCommand> steps;
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

}  // namespace
}  // namespace aurasim::cli
