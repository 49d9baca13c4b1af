// How long somebody waits for others, in virtual time.
#include "process/patience.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

class Waiting : public ::testing::Test {
 protected:
  /// Looks every `look`; the others have come so far.
  void pass(Patience::Clock::duration time, std::uint64_t progress, Patience::Clock::duration look = 50ms) {
    for (const auto end = now_ + time; now_ < end;) {
      now_ += look;
      patience_.look(progress, now_);
    }
  }
  bool is_over() const { return patience_.is_over(now_); }

  Patience::Clock::time_point now_{100s};
  Patience patience_{30s, now_};
};

TEST_F(Waiting, WithoutAnyNewsTheLimitCountsFromTheBeginning) {
  pass(29s, 0);
  EXPECT_FALSE(is_over());
  pass(2s, 0);
  EXPECT_TRUE(is_over());
}

TEST_F(Waiting, EveryStepForwardBeginsItAnew) {
  for (std::uint64_t i = 1; i <= 10; ++i) {
    pass(14s, i);
    EXPECT_FALSE(is_over());
  }
  pass(10s, 10);
  EXPECT_FALSE(is_over());
  pass(10s, 10);
  EXPECT_TRUE(is_over());
}

TEST_F(Waiting, WhatGoesBackAndForthIsNoNews) {
  pass(1s, 5);
  for (std::uint64_t i = 0; i < 40; ++i) pass(1s, 4 + i % 2);
  EXPECT_TRUE(is_over());
}

TEST_F(Waiting, PatienceGrowsWithHowLongNewsTakeToCome) {
  pass(28s, 0);
  pass(50s, 1);
  EXPECT_FALSE(is_over()) << "the first news took 28 s";
  pass(8s, 1);
  EXPECT_TRUE(is_over());
}

TEST_F(Waiting, PatienceGrowsWithHowSlowTheWaiterItselfIs) {
  pass(40s, 0, 2s);
  EXPECT_FALSE(is_over()) << "it looks every 2 s instead of 20 times a second";
  pass(90s, 0);
  EXPECT_TRUE(is_over());
}

}  // namespace
}  // namespace aurasim::process
