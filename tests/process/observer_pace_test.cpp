// Which states are told to an observer that is too slow for all of them.
#include "process/observer_pace.h"

#include <vector>

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using core::Step;

std::vector<Step> told(const ObserverPace& pace, std::uint32_t every, Step until) {
  std::vector<Step> steps;
  for (Step step = every; step <= until; step += every) {
    if (pace.is_for(step, every)) steps.push_back(step);
  }
  return steps;
}

TEST(ObserverPace, WhoKeepsUpIsToldEveryState) {
  ObserverPace pace;
  EXPECT_EQ(told(pace, 1, 4), (std::vector<Step>{1, 2, 3, 4}));
  EXPECT_EQ(told(pace, 10, 40), (std::vector<Step>{10, 20, 30, 40}));
}

TEST(ObserverPace, WhoIsTooSlowIsToldHalfOfThoseThatItWants) {
  ObserverPace pace;
  pace.note_too_slow();
  EXPECT_EQ(told(pace, 1, 8), (std::vector<Step>{2, 4, 6, 8}));
  EXPECT_EQ(told(pace, 10, 80), (std::vector<Step>{20, 40, 60, 80}));
  pace.note_too_slow();
  EXPECT_EQ(told(pace, 1, 8), (std::vector<Step>{4, 8}));
}

TEST(ObserverPace, OfTwoNodesBothTellWhatTheSlowerOneTells) {
  ObserverPace one, other;
  one.note_too_slow();
  for (int i = 0; i < 3; ++i) other.note_too_slow();
  for (const Step step : told(other, 5, 400)) EXPECT_TRUE(one.is_for(step, 5)) << step;
}

TEST(ObserverPace, WhoKeepsUpAgainIsToldMore) {
  ObserverPace pace;
  for (int i = 0; i < 20; ++i) pace.note_too_slow();
  EXPECT_TRUE(pace.is_for(1024, 1)) << "it is told something, however slow it is";
  int taken = 0;
  for (; !pace.is_for(1, 1); ++taken) pace.note_sent();
  EXPECT_EQ(taken, 320) << "32 for each doubling";
}

}  // namespace
}  // namespace aurasim::process
