// Which state is due when, and how run commands change that.
#include "process/run_schedule.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Kind = messages::RunCommandKind;

class RunScheduleTest : public ::testing::Test {
 protected:
  static constexpr std::int64_t kWallBegin = 1'000'000'000'000;

  RunScheduleTest() { schedule_.begin_world(0, start_in(0ms), at(0ms)); }

  static node::Instant at(std::chrono::milliseconds time) {
    return {node::Pacer(1, true).due(0) + 100s + time, kWallBegin + std::chrono::nanoseconds(time).count()};
  }
  static messages::RunCommand command(Kind kind, core::Step at_step, std::chrono::milliseconds due = 0ms) {
    messages::RunCommand command;
    command.kind = kind;
    command.at_step = at_step;
    command.epoch_ns = kWallBegin + std::chrono::nanoseconds(due).count();
    return command;
  }
  static messages::RunCommand start_in(std::chrono::milliseconds due) { return command(Kind::kStart, 0, due); }
  void apply(const messages::RunCommand& command, std::chrono::milliseconds time = 0ms) {
    schedule_.apply(command, at(time));
  }
  std::int64_t ms_until(core::Step step, std::chrono::milliseconds time) const {
    return std::chrono::duration_cast<std::chrono::milliseconds>(schedule_.time_until(step, at(time))).count();
  }

  RunSchedule schedule_{0.01, true, {}};
};

TEST_F(RunScheduleTest, StatesAreDueOneStepAfterTheOther) {
  EXPECT_EQ(ms_until(5, 0ms), 50);
  EXPECT_EQ(ms_until(5, 20ms), 30);
  EXPECT_EQ(ms_until(5, 70ms), 0);
  RunSchedule free(0.01, false, {});
  free.begin_world(0, start_in(10s), at(0ms));
  EXPECT_EQ(free.time_until(100, at(0ms)), 0ns);
}

TEST_F(RunScheduleTest, APauseHoldsInItsStateAndAResumeGoesOnAtItsTime) {
  apply(command(Kind::kPause, 10));
  EXPECT_FALSE(schedule_.is_held_in(9));
  EXPECT_TRUE(schedule_.is_held_in(10));
  apply(command(Kind::kResume, 0, 5s), 4s);
  EXPECT_FALSE(schedule_.holds_at());
  EXPECT_EQ(ms_until(11, 4s), 1000) << "the first state after the pause is due at the time that the command names";
}

TEST_F(RunScheduleTest, StepsCountOnlyInAPauseAndAddUp) {
  messages::RunCommand step = command(Kind::kStep, 12);
  step.count = 2;
  apply(step);
  EXPECT_FALSE(schedule_.holds_at()) << "not paused";
  apply(command(Kind::kPause, 10));
  step.request = 1;
  apply(step);
  step.request = 2;
  apply(step);
  EXPECT_EQ(schedule_.holds_at(), 14);
}

TEST_F(RunScheduleTest, InSlowMotionAStateThatAClientWaitsForComesInRealTime) {
  messages::RunCommand slow = command(Kind::kRate, 0);
  slow.rate = 0.01;
  apply(slow);
  schedule_.note_computed(at(0ms).steady);
  EXPECT_EQ(ms_until(1, 0ms), 1000);
  apply(command(Kind::kPause, 3));
  EXPECT_EQ(ms_until(1, 0ms), 10);
  EXPECT_EQ(ms_until(4, 0ms), 4000) << "after the pause it is slow again";
}

TEST_F(RunScheduleTest, TheEarliestStopCounts) {
  apply(command(Kind::kStop, 30));
  apply(command(Kind::kStop, 40));
  EXPECT_EQ(schedule_.stop_at(), 30);
  apply(command(Kind::kStop, 20));
  EXPECT_EQ(schedule_.stop_at(), 20);
  const RunSchedule limited(0.01, true, 7);
  EXPECT_EQ(limited.stop_at(), 7);
}

TEST_F(RunScheduleTest, AResetIsDueInItsStateAndTakenOnce) {
  messages::RunCommand reset = command(Kind::kReset, 30);
  reset.generation = 4;
  apply(reset);
  EXPECT_FALSE(schedule_.reset_is_due(29));
  EXPECT_TRUE(schedule_.reset_is_due(30));
  EXPECT_EQ(schedule_.reset_of(), 4U);
  EXPECT_EQ(schedule_.take_reset().at_step, 30);
  EXPECT_FALSE(schedule_.has_reset());
  EXPECT_FALSE(schedule_.reset_of());
}

TEST_F(RunScheduleTest, TheWayBackKeepsThePauseOnlyWithItsSender) {
  apply(command(Kind::kPause, 30));
  apply(command(Kind::kReset, 40));
  messages::RunCommand restore = command(Kind::kRestore, 12, 1s);
  restore.rate = 2;
  RunSchedule sender = schedule_;
  sender.go_back(restore, true, 0, at(0ms));
  schedule_.go_back(restore, false, 0, at(0ms));
  EXPECT_EQ(sender.holds_at(), 30);
  EXPECT_FALSE(schedule_.holds_at());
  EXPECT_FALSE(schedule_.has_reset());
  EXPECT_EQ(schedule_.rate(), 2);
  EXPECT_EQ(ms_until(14, 0ms), 1010) << "state 12 is due in a second, and the rate is 2";
}

TEST_F(RunScheduleTest, PauseResetAndStopAreSentAgainWithARestore) {
  apply(command(Kind::kPause, 30));
  apply(command(Kind::kReset, 8));
  apply(command(Kind::kStop, 50));
  messages::RunCommand restore = command(Kind::kRestore, 12);
  restore.generation = 3;
  restore.run = 9;
  const std::vector<messages::RunCommand> commands = schedule_.commands_to_repeat(restore);
  ASSERT_EQ(commands.size(), 3U);
  EXPECT_EQ(commands[0].kind, Kind::kReset);
  EXPECT_EQ(commands[0].at_step, 12) << "not before the state that all go back to";
  EXPECT_EQ(commands[1].kind, Kind::kPause);
  EXPECT_EQ(commands[1].at_step, 30);
  EXPECT_EQ(commands[2].kind, Kind::kStop);
  for (const messages::RunCommand& one : commands) {
    EXPECT_EQ(one.generation, 3U);
    EXPECT_EQ(one.run, 9U);
    EXPECT_EQ(one.request, 0U) << "a request of its own";
  }
  EXPECT_TRUE(RunSchedule(0.01, true, {}).commands_to_repeat(restore).empty());
}

TEST_F(RunScheduleTest, AnotherRateHoldsFromAStateThatNoNodeHasComputed) {
  const messages::RunCommand rate = schedule_.rate_command(3, 20, kWallBegin);
  EXPECT_EQ(rate.kind, Kind::kRate);
  EXPECT_EQ(rate.rate, 3);
  EXPECT_EQ(rate.at_step, 31);
  EXPECT_EQ(rate.epoch_ns, kWallBegin + 100'000'000);
}

TEST_F(RunScheduleTest, APausedRunComputesUpToAChangeUntilItsStateIsConfirmed) {
  EXPECT_FALSE(schedule_.steps_to(25, 20, 18, kWallBegin)) << "not paused";
  apply(command(Kind::kPause, 20));
  EXPECT_FALSE(schedule_.steps_to(25, 19, 18, kWallBegin)) << "not there yet";
  const auto steps = schedule_.steps_to(25, 20, 18, kWallBegin);
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->count, 7);
  EXPECT_EQ(steps->at_step, 27);
}

TEST_F(RunScheduleTest, PausesDoNotCountInTheRealTimeFactor) {
  schedule_.note_begun(0, at(0ms).steady);
  EXPECT_DOUBLE_EQ(schedule_.real_time_factor(100, at(2s).steady), 0.5);
  schedule_.note_pause(1s);
  EXPECT_DOUBLE_EQ(schedule_.real_time_factor(100, at(2s).steady), 1);
  EXPECT_DOUBLE_EQ(RunSchedule(0.01, true, {}).real_time_factor(100, at(2s).steady), 1) << "it has not begun";
}

TEST_F(RunScheduleTest, TheEpochOfAStateIsItsWallClockTime) {
  EXPECT_EQ(schedule_.epoch_of(100, at(30ms)), kWallBegin + 1'000'000'000);
}

TEST_F(RunScheduleTest, FollowsNodesThatPauseLaterOnlyInAPause) {
  schedule_.follow(50, at(0ms).steady);
  EXPECT_FALSE(schedule_.holds_at());
  apply(command(Kind::kPause, 30));
  schedule_.follow(50, at(0ms).steady);
  schedule_.follow(50, at(1s).steady);
  EXPECT_EQ(schedule_.holds_at(), 50);
  schedule_.hold_earlier_in(10);
  EXPECT_EQ(schedule_.holds_at(), 10);
}

}  // namespace
}  // namespace aurasim::process
