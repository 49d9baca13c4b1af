// Counts of setpoints that are late or refused, and setpoints that a step waits for.
#include "process/setpoint_intake.h"

#include <vector>

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

class SetpointIntakeTest : public ::testing::Test {
 protected:
  static constexpr std::chrono::steady_clock::time_point kBegin{100s};

  void take(std::vector<core::Heard> answers, std::uint64_t endpoints_refused = 0) {
    const std::vector<core::Setpoints> received(answers.size());
    std::size_t next = 0;
    intake_.take(received, endpoints_refused, 10, {}, [&](const core::Setpoints&, bool) { return answers.at(next++); });
  }
  bool may_compute(bool is_here, SetpointIntake::Clock::time_point now) {
    return intake_.has_all_awaited([is_here](const core::ProgramWord&) { return is_here; }, 11, now);
  }
  void await(std::uint64_t number) {
    messages::RunCommand step;
    step.after = {5, number};
    intake_.await(step, kBegin);
  }

  SetpointIntake intake_;
};

TEST_F(SetpointIntakeTest, CountsWhatTheNodeAnswers) {
  take({core::Heard::kInTime, core::Heard::kLate, core::Heard::kRefused, core::Heard::kInTime});
  EXPECT_EQ(intake_.counts().received, 4U);
  EXPECT_EQ(intake_.counts().late, 1U);
  EXPECT_EQ(intake_.counts().refused, 1U);
}

TEST_F(SetpointIntakeTest, CountsRefusalsOfTheEndpointsAndOfBodiesToo) {
  intake_.note_unbearable(3);
  take({core::Heard::kRefused}, 4);
  EXPECT_EQ(intake_.counts().refused, 8U);
  take({}, 6);
  EXPECT_EQ(intake_.counts().refused, 10U) << "the endpoints count by themselves";
}

TEST_F(SetpointIntakeTest, AStepWaitsForTheSetpointsThatItNames) {
  EXPECT_TRUE(may_compute(false, kBegin)) << "nothing is named";
  await(3);
  EXPECT_FALSE(may_compute(false, kBegin + 500ms));
  EXPECT_TRUE(may_compute(true, kBegin + 600ms));
  EXPECT_TRUE(may_compute(false, kBegin + 700ms)) << "received once is enough";
}

TEST_F(SetpointIntakeTest, SetpointsThatDoNotComeAreGivenUpAndCountAsRefused) {
  await(3);
  EXPECT_TRUE(may_compute(false, kBegin + 1s));
  take({});
  EXPECT_EQ(intake_.counts().refused, 1U);
}

TEST_F(SetpointIntakeTest, AnotherWorldWaitsForNothing) {
  await(3);
  intake_.begin_world();
  EXPECT_TRUE(may_compute(false, kBegin));
}

/// What the node of a paused run is given: the numbers of messages of program 5, and whether all nodes know them.
class SetpointsInAPause : public SetpointIntakeTest {
 protected:
  static core::Setpoints message(std::uint64_t number, core::Step at_step, bool of_static) {
    core::Setpoints said;
    said.client = 5, said.sequence = number, said.at_step = at_step;
    if (of_static) said.statics.push_back({core::StaticId{0}, {}, 1});
    return said;
  }
  std::vector<std::pair<std::uint64_t, bool>> give(const std::vector<core::Setpoints>& received,
                                                   std::optional<core::Step> holds_at) {
    std::vector<std::pair<std::uint64_t, bool>> given;
    intake_.take(received, 0, 10, holds_at, [&](const core::Setpoints& said, bool known_to_all) {
      given.emplace_back(said.sequence, known_to_all);
      return core::Heard::kInTime;
    });
    return given;
  }
  using Given = std::vector<std::pair<std::uint64_t, bool>>;
};

TEST_F(SetpointsInAPause, OfStaticsAreKeptForTheStepThatNamesThem) {
  EXPECT_EQ(give({message(1, 11, false), message(2, 11, true)}, 10), (Given{{1, false}}));
  EXPECT_EQ(give({}, 10), Given());
  await(2);
  EXPECT_EQ(give({}, 11), (Given{{2, true}}));
  EXPECT_EQ(intake_.counts().received, 2U);
}

TEST_F(SetpointsInAPause, ThatComeAfterTheStepThatNamesThemAreKnownToAllToo) {
  await(2);
  EXPECT_FALSE(may_compute(false, kBegin + 1ms));
  EXPECT_EQ(give({message(2, 11, true), message(3, 11, true)}, 11), (Given{{2, true}, {3, false}}))
      << "no node waits for the third";
}

TEST_F(SetpointsInAPause, AreNotKnownToAllWhereAnotherProgramEndsThePause) {
  EXPECT_EQ(give({message(2, 11, true)}, 10), Given());
  EXPECT_EQ(give({}, {}), (Given{{2, false}}));
}

TEST_F(SetpointsInAPause, AreDroppedWithTheWorldThatTheyWereFor) {
  EXPECT_EQ(give({message(2, 11, true)}, 10), Given());
  intake_.begin_world();
  EXPECT_EQ(give({}, {}), Given());
}

}  // namespace
}  // namespace aurasim::process
