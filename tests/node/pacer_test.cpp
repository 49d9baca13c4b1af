// When steps are due, whatever the hosts' wall clocks do. Virtual time.
#include "node/pacer.h"

#include <gtest/gtest.h>

namespace aurasim::node {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr double kPacedStep_s = 0.1;
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kNoon = 1'700'000'000 * kSecond;

/// A host whose wall clock may be wrong.
struct Host {
  Instant now{std::chrono::steady_clock::time_point(1h), kNoon};

  void pass(nanoseconds time) {
    now.steady += time;
    now.wall_ns += time.count();
  }
  void set_wall_clock(nanoseconds forward) { now.wall_ns += forward.count(); }
};

TEST(Pacer, StepsFollowTheEpochThatAllHostsHave) {
  Host host;
  Pacer pacer(kPacedStep_s, true);
  pacer.set_epoch(5, kNoon + kSecond / 2, 0ns, host.now);
  EXPECT_EQ(pacer.until(5, host.now), 500ms);
  EXPECT_EQ(pacer.until(7, host.now), 700ms);
  host.pass(600ms);
  EXPECT_EQ(pacer.until(5, host.now), 0ns);
  EXPECT_EQ(pacer.until(7, host.now), 100ms);
}

TEST(Pacer, AWallClockThatJumpsChangesNothing) {
  for (const nanoseconds jump : {nanoseconds(20s), nanoseconds(-20s)}) {
    Host host;
    Pacer pacer(kPacedStep_s, true);
    pacer.set_epoch(0, kNoon, 0ns, host.now);
    host.pass(1s);
    host.set_wall_clock(jump);
    EXPECT_EQ(pacer.until(10, host.now), 0ns);
    EXPECT_EQ(pacer.until(11, host.now), 100ms);
    pacer.set_rate(0.5, 10, host.now.wall_ns, 0ns, host.now);
    EXPECT_EQ(pacer.until(11, host.now), 200ms);
  }
}

TEST(Pacer, AnEpochFromAHostWithAWrongClockCountsFromWhenItCame) {
  for (const nanoseconds ahead : {nanoseconds(30s), nanoseconds(-30s), nanoseconds(24h)}) {
    Host host;
    Pacer pacer(kPacedStep_s, true);
    pacer.set_epoch(0, kNoon + ahead.count() + kSecond / 2, ahead, host.now);
    EXPECT_EQ(pacer.until(0, host.now), 500ms);
  }
}

TEST(Pacer, WhatAMessageTookIsNotHeldForAWrongClock) {
  Host host;
  Pacer pacer(kPacedStep_s, true);
  pacer.set_epoch(0, kNoon + kSecond / 2, -100ms, host.now);
  EXPECT_EQ(pacer.until(0, host.now), 500ms);
}

TEST(Pacer, ARateHoldsFromItsOwnStepAndTime) {
  Host host;
  Pacer pacer(kPacedStep_s, true);
  pacer.set_epoch(0, kNoon, 0ns, host.now);
  pacer.set_rate(0.5, 10, kNoon + kSecond, 0ns, host.now);
  EXPECT_EQ(pacer.until(10, host.now), 1s);
  EXPECT_EQ(pacer.until(15, host.now), 2s);
}

/// However slow it was: the next step is not minutes away.
TEST(Pacer, ASlowRateIsUndoneAtOnce) {
  Host host;
  Pacer pacer(kPacedStep_s, true);
  pacer.set_rate(0.01, 10, kNoon, 0ns, host.now);
  EXPECT_EQ(pacer.until(12, host.now), 20s);
  pacer.set_rate(1, 11, kNoon + kSecond, 0ns, host.now);
  EXPECT_EQ(pacer.until(12, host.now), 1100ms);
}

TEST(Pacer, ANewEpochKeepsTheRate) {
  Host host;
  Pacer pacer(kPacedStep_s, true);
  pacer.set_rate(2, 10, kNoon, 0ns, host.now);
  pacer.set_epoch(0, kNoon + kSecond, 0ns, host.now);
  EXPECT_EQ(pacer.until(20, host.now), 2s);
}

TEST(Pacer, WithoutPaceEveryStepIsDue) {
  Host host;
  Pacer pacer(kPacedStep_s, false);
  pacer.set_epoch(0, kNoon + kSecond, 0ns, host.now);
  EXPECT_EQ(pacer.until(1000, host.now), 0ns);
}

TEST(ClockWatch, NamesAJumpOnceAndByHowMuch) {
  Host host;
  ClockWatch watch(host.now);
  host.pass(1h);
  EXPECT_EQ(watch.look(host.now), 0ns);
  host.pass(100ms);
  host.set_wall_clock(20s);
  EXPECT_EQ(watch.look(host.now), 20s);
  EXPECT_EQ(watch.look(host.now), 0ns);
  host.set_wall_clock(-20s);
  EXPECT_EQ(watch.look(host.now), -20s);
  host.pass(1s);
  host.set_wall_clock(1ms);
  EXPECT_EQ(watch.look(host.now), 0ns) << "as a time server turns it";
}

}  // namespace
}  // namespace aurasim::node
