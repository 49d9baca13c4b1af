// What is in effect in which state, of all that programs have said.
#include "core/control_log.h"

#include <optional>
#include <random>
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

/// The x of kBody's; -1: nothing is in effect.
double in_effect(const ControlLog& log, Quantity quantity, Step step) {
  double x = -1;
  log.for_each_of(kBody, step, [&](Quantity one, const std::optional<Vec3>& value, bool) {
    if (one == quantity && value) x = value->x();
  });
  return x;
}

double force_in(const ControlLog& log, Step step) { return in_effect(log, Quantity::kForce, step); }

/// As often as it takes: it goes bit by bit.
void forget(ControlLog& log, Step step) {
  for (int call = 0; call < 100; ++call) log.forget_before(step);
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
  EXPECT_EQ(in_effect(log, Quantity::kVelocity, 51), GetParam().speed);
  std::optional<JointDrive> drive;
  log.for_each_joint(51, [&](JointId, const auto& in_effect, bool) { drive = in_effect; });
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
  log.for_each_ahead(
      25, 50, [](BodyId id) { return id == kBody; },
      [&](BodyId, Quantity, const Vec3& value) { told.push_back(value.x()); });
  EXPECT_EQ(told, (std::vector<double>{20, 30, 40, 50}));
}

/// Whatever was asked for before, and in whatever order it was said.
TEST(ControlLog, TheSameIsInEffectWhateverWasAskedForBefore) {
  std::mt19937_64 random(5);
  std::vector<Setpoints> words;
  for (std::uint64_t i = 0; i < 300; ++i) {
    Setpoints& said = words.emplace_back();
    said.client = 1 + random() % 3, said.sequence = i, said.at_step = 1 + static_cast<Step>(random() % 60);
    for (std::uint64_t k = random() % 12; k > 0; --k) {
      const auto quantity = static_cast<Quantity>(random() % kQuantities);
      said.bodies.push_back({BodyId{random() % 10}, quantity, {}});
      if (random() % 4 != 0) said.bodies.back().value = Vec3(static_cast<double>(random() % 1000), 0, 0);
    }
  }
  const auto all_in_effect = [](const ControlLog& log, Step step) {
    std::string text;
    log.for_each_body(
        step, [](BodyId) { return true; },
        [&](BodyId id, Quantity quantity, const auto& value, bool is_new) {
          text += std::to_string(value_of(id)) + ' ' + std::to_string(static_cast<int>(quantity)) + ' ' +
                  (value ? std::to_string(value->x()) : "none") + (is_new ? " new; " : "; ");
        });
    return text;
  };
  ControlLog once;
  for (const Setpoints& said : words) once.recall(said);
  std::vector<std::string> expected;
  for (Step step = 0; step < 70; ++step) {  // what has been said of each, looked for one by one
    ControlLog fresh;
    for (const Setpoints& said : words) {
      if (said.at_step <= step) fresh.recall(said);
    }
    expected.push_back(all_in_effect(fresh, step));
  }
  ControlLog other;
  for (std::size_t i = 0; i < words.size(); ++i) {
    other.recall(words[words.size() - 1 - i]);
    all_in_effect(other, static_cast<Step>(random() % 70));
  }
  for (int look = 0; look < 300; ++look) {
    const auto step = static_cast<Step>(random() % 70);
    EXPECT_EQ(all_in_effect(once, step), expected[static_cast<std::size_t>(step)]) << step;
    EXPECT_EQ(all_in_effect(other, step), expected[static_cast<std::size_t>(step)]) << step;
  }
  for (Step oldest = 1; oldest < 40; ++oldest) other.forget_before(oldest);
  for (Step step = 40; step < 70; ++step)
    EXPECT_EQ(all_in_effect(other, step), expected[static_cast<std::size_t>(step)]);
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
  forget(log, 30);
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

/// Whatever a node has forgotten meanwhile.
TEST(ControlLog, WhoSpeaksAgainAfterALongSilenceGoesOn) {
  for (const OnSilence rule : {OnSilence::kHold, OnSilence::kZero, OnSilence::kLast}) {
    ControlLog log, forgetful;
    for (ControlLog* one : {&log, &forgetful}) {
      one->use({LateSetpoint::kNextState, rule, 30});
      one->recall(force(1, 1, 10, 5));
    }
    for (Step step = 1; step < 1000; ++step) forgetful.forget_before(step);
    for (ControlLog* one : {&log, &forgetful}) {
      EXPECT_EQ(force_in(*one, 1000), rule == OnSilence::kLast ? 5 : -1);
      one->recall({1, 2, 0, 1010, {}, {}});
      EXPECT_EQ(force_in(*one, 1010), 5);
    }
  }
}

TEST(ControlLog, ForgetsWhatIsOver) {
  ControlLog log;
  for (Step step = 1; step <= 100; ++step) log.recall(force(1, static_cast<std::uint64_t>(step), step, double(step)));
  forget(log, 90);
  EXPECT_EQ(force_in(log, 90), 90);
  EXPECT_EQ(force_in(log, 100), 100);
  EXPECT_EQ(force_in(log, 89), -1);
  log.recall({1, 101, 0, 101, {{kBody, Quantity::kForce, {}}}, {}});
  forget(log, 200);
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
