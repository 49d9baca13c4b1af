// How long somebody waits for others, in virtual time.
#include "cli/patience.h"

#include <gtest/gtest.h>

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;

constexpr Patience::Clock::time_point kBegin{100s};

TEST(PatienceTest, WithoutAnyNewsTheLimitCountsFromTheBeginning) {
  Patience patience(30s, kBegin);
  patience.look(0, kBegin + 29s);
  EXPECT_FALSE(patience.is_over(kBegin + 30s));
  EXPECT_TRUE(patience.is_over(kBegin + 31s));
}

TEST(PatienceTest, EveryStepForwardBeginsItAnew) {
  Patience patience(30s, kBegin);
  for (int i = 1; i <= 10; ++i) {
    EXPECT_FALSE(patience.is_over(kBegin + i * 20s));
    patience.look(static_cast<std::uint64_t>(i), kBegin + i * 20s);
  }
  EXPECT_FALSE(patience.is_over(kBegin + 220s));
  EXPECT_TRUE(patience.is_over(kBegin + 250s));
}

TEST(PatienceTest, WhatGoesBackAndForthIsNoNews) {
  Patience patience(30s, kBegin);
  patience.look(5, kBegin);
  for (int i = 1; i <= 40; ++i) patience.look(static_cast<std::uint64_t>(4 + i % 2), kBegin + i * 1s);
  EXPECT_TRUE(patience.is_over(kBegin + 40s));
}

TEST(PatienceTest, GrowsWithHowLongNewsTakeToCome) {
  Patience patience(30s, kBegin);
  patience.look(1, kBegin + 28s);
  patience.look(2, kBegin + 56s);
  EXPECT_FALSE(patience.is_over(kBegin + 56s + 50s)) << "they came 28 s apart";
  EXPECT_TRUE(patience.is_over(kBegin + 56s + 57s));
}

}  // namespace
}  // namespace aurasim::cli
