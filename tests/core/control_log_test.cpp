// What is in effect in which state, of all that programs have said.
#include "core/control_log.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

constexpr BodyId kBody{7};
constexpr JointId kJoint{2};
constexpr std::size_t kJoints = 3;
constexpr Step kControlNotice = 3;

Setpoints force(std::uint64_t client, std::uint64_t sequence, Step at, double x) {
  return {client, sequence, 0, at, {{kBody, Quantity::kForce, Vec3(x, 0, 0)}}, {}};
}

double force_in(const ControlLog& log, Step step) {
  return log.in_effect(kBody, Quantity::kForce, step).value_or(Vec3(-1, 0, 0)).x();
}

TEST(ControlLog, ASetpointHoldsFromItsStateUntilTheNextOne) {
  ControlLog log;
  EXPECT_EQ(log.hear(force(1, 1, 10, 5), 8, kControlNotice, kJoints), Heard::kInTime);
  EXPECT_EQ(log.hear(force(1, 2, 12, 6), 8, kControlNotice, kJoints), Heard::kInTime);
  EXPECT_EQ(force_in(log, 9), -1);
  EXPECT_EQ(force_in(log, 10), 5);
  EXPECT_EQ(force_in(log, 11), 5);
  EXPECT_EQ(force_in(log, 12), 6);
}

TEST(ControlLog, WithoutAStateItTakesEffectAfterTheNotice) {
  ControlLog log;
  log.hear(force(1, 1, 0, 5), 8, kControlNotice, kJoints);
  EXPECT_EQ(force_in(log, 10), -1);
  EXPECT_EQ(force_in(log, 11), 5);
}

TEST(ControlLog, TheOrderOfArrivalDoesNotMatter) {
  ControlLog log, other;
  const Setpoints messages[] = {force(1, 1, 10, 5), force(2, 1, 10, 6), force(1, 2, 10, 7), force(1, 3, 9, 8)};
  for (const Setpoints& one : messages) log.recall(one);
  for (int i = 3; i >= 0; --i) other.recall(messages[i]);
  EXPECT_EQ(force_in(log, 9), 8);
  EXPECT_EQ(force_in(log, 10), 6);  // of the larger client
  for (Step step = 8; step < 12; ++step) EXPECT_EQ(force_in(log, step), force_in(other, step));
}

TEST(ControlLog, WhatIsLateTakesEffectInTheNextStateOrNotAtAll) {
  ControlLog next, drop;
  drop.use({LateSetpoint::kDropped, OnSilence::kHold, 30});
  EXPECT_EQ(next.hear(force(1, 1, 8, 5), 8, kControlNotice, kJoints), Heard::kLate);
  EXPECT_EQ(drop.hear(force(1, 1, 8, 5), 8, kControlNotice, kJoints), Heard::kLate);
  EXPECT_EQ(force_in(next, 8), -1);
  EXPECT_EQ(force_in(next, 9), 5);
  EXPECT_EQ(force_in(drop, 9), -1);
}

TEST(ControlLog, RefusesUnknownJointsAndStatesFarAhead) {
  ControlLog log;
  Setpoints drive{1, 1, 0, 10, {}, {{JointId{3}, JointDrive{}}}};
  EXPECT_EQ(log.hear(drive, 8, kControlNotice, kJoints), Heard::kRefused);
  EXPECT_EQ(log.hear(force(1, 1, 1'000'000, 5), 8, kControlNotice, kJoints), Heard::kRefused);
  EXPECT_TRUE(log.empty());
}

TEST(ControlLog, LettingGoIsToldOnce) {
  ControlLog log;
  log.recall(force(1, 1, 10, 5));
  log.recall({1, 2, 0, 20, {{kBody, Quantity::kForce, {}}}, {}});
  const auto told = [&log](Step step) {
    std::string text;
    log.for_each_body(
        step, [](BodyId) { return true; },
        [&](BodyId, Quantity, const auto& value, bool is_new) {
          text += value ? "value" : "none";
          if (is_new) text += " new";
        });
    return text;
  };
  EXPECT_EQ(told(9), "");
  EXPECT_EQ(told(10), "value new");
  EXPECT_EQ(told(11), "value");
  EXPECT_EQ(told(20), "none new");
  EXPECT_EQ(told(21), "");
}

struct Silent {
  OnSilence rule;
  double force, speed;  ///< -1: nothing is in effect
  bool drives;
};

class ProgramSilence : public ::testing::TestWithParam<Silent> {};

TEST_P(ProgramSilence, IsWhatTheLaunchFileSays) {
  ControlLog log;
  log.use({LateSetpoint::kNextState, GetParam().rule, 30});
  log.recall({1,
              1,
              0,
              10,
              {{kBody, Quantity::kForce, Vec3(5, 0, 0)}, {kBody, Quantity::kVelocity, Vec3(2, 0, 0)}},
              {{kJoint, JointDrive{0.5, 3, 100, 10, 4, 50}}}});
  log.recall({1, 2, 0, 20, {}, {}});  // a word is enough
  EXPECT_EQ(force_in(log, 50), 5);
  EXPECT_EQ(force_in(log, 51), GetParam().force);
  EXPECT_EQ(log.in_effect(kBody, Quantity::kVelocity, 51).value_or(Vec3(-1, 0, 0)).x(), GetParam().speed);
  const auto drive = log.in_effect(kJoint, 51);
  ASSERT_EQ(drive.has_value(), GetParam().drives);
  if (!drive) return;
  EXPECT_EQ(drive->position, 0.5);
  EXPECT_EQ(drive->speed, GetParam().rule == OnSilence::kLast ? 3 : 0);
  EXPECT_EQ(drive->effort, GetParam().rule == OnSilence::kLast ? 4 : 0);
}

INSTANTIATE_TEST_SUITE_P(Rules, ProgramSilence,
                         ::testing::Values(Silent{OnSilence::kHold, -1, 0, true},
                                           Silent{OnSilence::kZero, -1, -1, false},
                                           Silent{OnSilence::kLast, 5, 2, true}));

TEST(ControlLog, WhatIsKnownToComeIsToldOfUpToAState) {
  ControlLog log;
  for (Step step = 10; step <= 1000; step += 10) log.recall(force(1, static_cast<std::uint64_t>(step), step, step));
  std::vector<double> told;
  std::size_t hint = 0;
  log.for_each_ahead(kBody, 25, 50, hint, [&](Quantity, const Vec3& value) { told.push_back(value.x()); });
  std::ranges::sort(told);
  EXPECT_EQ(told, (std::vector<double>{20, 30, 40, 50}));
}

TEST(ControlLog, WhatIsToComeIsTheSameWhereverOneHasLookedBefore) {
  ControlLog log;
  for (std::uint64_t id = 2; id < 40; id += 3) {
    log.recall({1, id, 0, 10, {{BodyId{id}, Quantity::kForce, Vec3(double(id), 0, 0)}}, {}});
    log.recall({1, 100 + id, 0, 10, {{BodyId{id}, Quantity::kSpin, Vec3(double(id), 0, 0)}}, {}});
  }
  for (std::size_t before = 0; before < 40; ++before) {
    for (std::uint64_t id = 0; id < 42; ++id) {
      std::size_t hint = before, told = 0;
      log.for_each_ahead(BodyId{id}, 10, 20, hint, [&](Quantity, const Vec3& value) {
        EXPECT_EQ(value.x(), double(id));
        ++told;
      });
      EXPECT_EQ(told, id < 40 && id % 3 == 2 ? 2u : 0u) << id << " after " << before;
    }
  }
}

TEST(ControlLog, ForgetsManyBitByBit) {
  ControlLog log;
  for (Step step = 1; step <= 20; ++step) {
    Setpoints all{1, static_cast<std::uint64_t>(step), 0, step, {}, {}};
    for (std::uint64_t id = 0; id < 100; ++id) {
      const bool is_last = step == 20 && id % 2 == 0;
      all.bodies.push_back({BodyId{id}, Quantity::kForce, is_last ? std::nullopt : std::optional(Vec3(1, 0, 0))});
    }
    log.recall(all);
  }
  for (std::size_t i = 0; i < 2 * ControlLog::kForgetCalls; ++i) log.forget_before(30);
  std::size_t left = 0;
  for (const Setpoints& message : log.since(0)) left += message.bodies.size();
  EXPECT_EQ(left, 50u) << "one of each that is not let go of";
}

/// Also long after the newest one, and between old ones.
TEST(ControlLog, OfABodyOnlyItsOwnIsVisited) {
  ControlLog log;
  for (Step step = 10; step <= 400; step += 10) {
    log.recall(force(1, static_cast<std::uint64_t>(step), step, step));
    log.recall({1, static_cast<std::uint64_t>(step), 0, step, {{BodyId{8}, Quantity::kSpin, Vec3(0, 0, step)}}, {}});
  }
  for (const Step step : {10, 11, 205, 400, 401}) {
    std::string told;
    log.for_each_of(kBody, step, [&](Quantity quantity, const auto& value, bool is_new) {
      EXPECT_EQ(quantity, Quantity::kForce);
      told = std::to_string(static_cast<int>(value->x())) + (is_new ? " new" : "");
    });
    EXPECT_EQ(told, std::to_string(step / 10 * 10) + (step % 10 == 0 ? " new" : "")) << step;
  }
}

TEST(ControlLog, ARecordNeverFallsSilent) {
  ControlLog log;
  log.recall(force(kRecordedClient, 1, 10, 5));
  EXPECT_EQ(force_in(log, 100'000), 5);
}

TEST(ControlLog, ForgetsWhatIsOver) {
  ControlLog log;
  for (Step step = 1; step <= 100; ++step) log.recall(force(1, static_cast<std::uint64_t>(step), step, double(step)));
  log.forget_before(90);
  EXPECT_EQ(force_in(log, 90), 90);
  EXPECT_EQ(force_in(log, 100), 100);
  EXPECT_EQ(force_in(log, 89), -1);
  log.recall({1, 101, 0, 101, {{kBody, Quantity::kForce, {}}}, {}});
  log.forget_before(200);
  EXPECT_TRUE(log.empty());
}

TEST(ControlLog, TellsAnotherOneWhatIsInEffectSinceAState) {
  ControlLog log;
  for (Step step = 1; step <= 100; step += 3)
    log.recall(force(1, static_cast<std::uint64_t>(step), step, double(step)));
  ControlLog other;
  for (const Setpoints& one : log.since(50)) other.recall(one);
  for (Step step = 50; step <= 140; ++step) EXPECT_EQ(force_in(other, step), force_in(log, step)) << step;
}

}  // namespace
}  // namespace aurasim::core
