// What a run command may name.
#include "process/run_control_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = messages::RunCommandKind;
using namespace std::chrono_literals;

constexpr std::int64_t kNow = 1'700'000'000'000'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;

/// 60 states a second.
class ARunCommand : public ::testing::Test {
 protected:
  void run_for(std::chrono::seconds time) {
    for (const auto end = now_ + time; now_ < end; now_ += 250ms) limits_.note(step_ += 15, now_);
  }
  std::string problem(Kind kind, core::Step at_step, std::int64_t epoch_ns = kNow) {
    messages::RunCommand command;
    command.kind = kind;
    command.at_step = at_step;
    command.epoch_ns = epoch_ns;
    return limits_.problem_with(command, 3, kNow);
  }

  RunControlLimits limits_;
  RunControlLimits::Time now_ = RunControlLimits::Time() + 1h;
  core::Step step_ = 0;
};

TEST_F(ARunCommand, ForAStateThatWasPastLongAgoIsNotMeant) {
  run_for(20s);
  for (const Kind kind : {Kind::kStop, Kind::kPause, Kind::kReset, Kind::kStep, Kind::kRate}) {
    EXPECT_THAT(problem(kind, 0), HasSubstr("state 0 was past 5 s ago"));
    EXPECT_THAT(problem(kind, step_ - 400), HasSubstr("was past"));
    EXPECT_THAT(problem(kind, step_ - 200), IsEmpty()) << "it was 3 s on its way";
    EXPECT_THAT(problem(kind, step_ + 60), IsEmpty());
    EXPECT_THAT(problem(kind, step_ + 2'000'000), HasSubstr("ahead"));
  }
  EXPECT_THAT(problem(Kind::kResume, 0), IsEmpty()) << "its state does not matter";
}

TEST_F(ARunCommand, AtTheBeginningMayNameAnyState) {
  EXPECT_THAT(problem(Kind::kStop, 0), IsEmpty());
  run_for(2s);
  EXPECT_THAT(problem(Kind::kStop, 0), IsEmpty());
}

TEST_F(ARunCommand, BeforeTheFirstStateAfterAResetMayNameOneOfTheNewWorld) {
  run_for(20s);
  limits_.begin(0, now_);
  EXPECT_THAT(problem(Kind::kPause, 40), IsEmpty());
}

TEST_F(ARunCommand, AfterTheRunHasGoneBackMayNameWhatIsAheadAgain) {
  run_for(20s);
  step_ = 600;
  run_for(1s);
  EXPECT_THAT(problem(Kind::kPause, 700), IsEmpty());
}

/// A command that named a state of long ago was believed for five seconds after a redo.
TEST_F(ARunCommand, AfterTheRunHasGoneBackMayNotNameWhatWasPastAllTheSame) {
  run_for(20s);
  for (const core::Step back : {step_ - 4, step_ - 30, core::Step{600}}) {
    limits_.note(back, now_);
    EXPECT_THAT(problem(Kind::kStop, 0), HasSubstr("was past")) << back;
    EXPECT_THAT(problem(Kind::kStop, back), IsEmpty()) << back;
    EXPECT_THAT(problem(Kind::kStop, back + 200), IsEmpty()) << back;
    step_ = back;
    run_for(2s);
    EXPECT_THAT(problem(Kind::kStop, 0), HasSubstr("was past")) << back;
  }
  limits_.note(0, now_);
  EXPECT_THAT(problem(Kind::kStop, 0), IsEmpty()) << "the run is there again";
}

TEST_F(ARunCommand, NamesATimeWithinAMinute) {
  for (const Kind kind : {Kind::kStart, Kind::kReset, Kind::kResume, Kind::kStep, Kind::kRate}) {
    EXPECT_THAT(problem(kind, 10, kNow + 10 * kSecond), IsEmpty());
    EXPECT_THAT(problem(kind, 10, 2 * kNow), HasSubstr("ahead"));
    EXPECT_THAT(problem(kind, 10, kNow - 3600 * kSecond), HasSubstr("ago"));
  }
  EXPECT_THAT(problem(Kind::kRestore, 10, kNow - 3600 * kSecond), IsEmpty()) << "the run may be far behind";
  EXPECT_THAT(problem(Kind::kRestore, 10, 2 * kNow), HasSubstr("ahead"));
}

TEST_F(ARunCommand, NamesItBySendersClock) {
  messages::RunCommand command;
  command.kind = Kind::kStart;
  command.clock_ahead = 1h;
  command.epoch_ns = kNow + 3600 * kSecond;
  EXPECT_THAT(limits_.problem_with(command, 0, kNow), IsEmpty());
  command.epoch_ns = kNow;
  EXPECT_THAT(limits_.problem_with(command, 0, kNow), HasSubstr("3.6e+03 s ago"));
}

TEST_F(ARunCommand, RestoresNoGenerationOutOfNowhere) {
  messages::RunCommand command;
  command.kind = Kind::kRestore;
  command.epoch_ns = kNow;
  command.generation = 4;
  EXPECT_THAT(limits_.problem_with(command, 3, kNow), IsEmpty());
  command.generation = 4'000'000'000U;
  EXPECT_THAT(limits_.problem_with(command, 3, kNow), HasSubstr("generation"));
}

}  // namespace
}  // namespace aurasim::process
