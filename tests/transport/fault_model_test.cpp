#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "transport/faulty_transport.h"

namespace aurasim::transport::testing {
namespace {

using core::RegionId;
using ::testing::ElementsAre;

constexpr RegionId kA{0}, kB{1}, kC{2};
constexpr std::uint64_t kSeed = 5;

Faults rough() {
  Faults faults;
  faults.latency_s = 0.002;
  faults.jitter_s = 0.004;
  faults.loss = 0.25;
  faults.duplicate = 0.25;
  return faults;
}

/// Arrivals of messages sent every millisecond.
std::vector<double> arrivals_of(FaultModel& model, int messages) {
  std::vector<double> times;
  for (int i = 0; i < messages; ++i) {
    for (const double t : model.arrivals(kA, kB, 0.001 * i)) times.push_back(t);
  }
  return times;
}

TEST(FaultModel, TheSameSeedGivesTheSameArrivals) {
  FaultModel one(rough(), kSeed), same(rough(), kSeed), other(rough(), kSeed + 1);
  const std::vector<double> first = arrivals_of(one, 1000);
  EXPECT_EQ(first, arrivals_of(same, 1000));
  EXPECT_NE(first, arrivals_of(other, 1000));
}

TEST(FaultModel, AFaultlessLinkTakesTheLatency) {
  Faults faults;
  faults.latency_s = 0.5;
  FaultModel model(faults, kSeed);
  EXPECT_THAT(model.arrivals(kA, kB, 1), ElementsAre(1.5));
}

TEST(FaultModel, JitterStaysWithinItsBounds) {
  Faults faults = rough();
  faults.loss = faults.duplicate = 0;
  faults.keep_order = false;
  FaultModel model(faults, kSeed);
  double least = 1, most = 0;
  for (int i = 0; i < 2000; ++i) {
    const double delay = model.arrivals(kA, kB, i)[0] - i;
    least = std::min(least, delay);
    most = std::max(most, delay);
  }
  EXPECT_GE(least, faults.latency_s - 1e-9);
  EXPECT_LE(most, faults.latency_s + faults.jitter_s + 1e-9);
  EXPECT_GT(most - least, 0.9 * faults.jitter_s);
}

TEST(FaultModel, OrderIsKeptWhenAsked) {
  FaultModel model(rough(), kSeed);
  const std::vector<double> times = arrivals_of(model, 2000);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
}

TEST(FaultModel, OrderIsLostWhenNotAskedFor) {
  Faults faults = rough();
  faults.keep_order = false;
  FaultModel model(faults, kSeed);
  const std::vector<double> times = arrivals_of(model, 2000);
  EXPECT_FALSE(std::is_sorted(times.begin(), times.end()));
}

TEST(FaultModel, OrderOfOnePairDoesNotHoldUpAnother) {
  Faults faults;
  faults.latency_s = 0.001;
  FaultModel model(faults, kSeed);
  model.cut(kA, kB, 0, 10);
  EXPECT_THAT(model.arrivals(kA, kB, 1), ElementsAre(10.001));
  EXPECT_THAT(model.arrivals(kA, kC, 1), ElementsAre(1.001));
  EXPECT_THAT(model.arrivals(kC, kB, 1), ElementsAre(1.001));
}

TEST(FaultModel, LossOnlyDelays) {
  Faults faults;
  faults.loss = 0.5;
  faults.resend_after_s = 0.01;
  faults.keep_order = false;
  FaultModel model(faults, kSeed);
  int delayed = 0, twice_delayed = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::vector<double> times = model.arrivals(kA, kB, i);
    ASSERT_EQ(times.size(), 1u);
    delayed += times[0] > i + 0.009;
    twice_delayed += times[0] > i + 0.019;
  }
  EXPECT_NEAR(delayed, 2000, 150);
  EXPECT_NEAR(twice_delayed, 1000, 150);
}

TEST(FaultModel, DuplicatesComeTwice) {
  Faults faults;
  faults.duplicate = 0.3;
  FaultModel model(faults, kSeed);
  int twice = 0;
  for (int i = 0; i < 4000; ++i) twice += model.arrivals(kA, kB, i).size() == 2;
  EXPECT_NEAR(twice, 1200, 120);
}

TEST(FaultModel, ACutHoldsMessagesInBothDirectionsUntilItEnds) {
  FaultModel model({}, kSeed);
  model.cut(kA, kB, 2, 5);
  EXPECT_THAT(model.arrivals(kA, kB, 1.9), ElementsAre(1.9));
  EXPECT_THAT(model.arrivals(kA, kB, 2), ElementsAre(5));
  EXPECT_THAT(model.arrivals(kB, kA, 4.9), ElementsAre(5));
  EXPECT_THAT(model.arrivals(kA, kB, 5), ElementsAre(5));
  EXPECT_THAT(model.arrivals(kA, kC, 3), ElementsAre(3));
}

TEST(FaultModel, AMessageWaitsForAllCutsInARow) {
  FaultModel model({}, kSeed);
  model.cut(kA, kB, 2, 5);
  model.cut(kA, kB, 5, 8);
  EXPECT_THAT(model.arrivals(kA, kB, 3), ElementsAre(8));
}

/// The same two cuts, the later one first.
TEST(FaultModel, AMessageWaitsForAllCutsInWhicheverOrderTheyWereMade) {
  FaultModel model({}, kSeed);
  model.cut(kA, kB, 5, 8);
  model.cut(kA, kB, 2, 5);
  EXPECT_THAT(model.arrivals(kA, kB, 3), ElementsAre(8));
}

TEST(FaultModel, WhatWasLostDuringACutIsSentAgainAfterIt) {
  Faults faults;
  faults.loss = 0.9;
  faults.resend_after_s = 0.5;
  faults.keep_order = false;
  FaultModel model(faults, kSeed);
  model.cut(kA, kB, 1, 3);
  for (int i = 0; i < 500; ++i) {
    const double t = model.arrivals(kA, kB, 0.6)[0];
    EXPECT_TRUE(t < 1 || t >= 3) << t;
  }
}

}  // namespace
}  // namespace aurasim::transport::testing
