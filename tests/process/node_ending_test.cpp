// Whom the launcher waits for after Ctrl-C, in virtual time.
#include "process/node_ending.h"

#include <optional>

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = NodeEnding::Clock;

class NodeEndingTest : public ::testing::Test {
 protected:
  /// Time goes by; the node's status comes every 100 ms unless it is lost. What the launcher does first, and when.
  struct Deed {
    Urge urge = Urge::kNone;
    Clock::duration after{};
  };
  Deed first_deed(Clock::duration for_time, core::Step steps_per_status = 0) {
    for (; now_ < begin_ + for_time; now_ += 100ms) {
      if (seen_ && !seen_->lost) {
        seen_->seen = now_;
        seen_->status.step += steps_per_status;
      }
      const Urge urge = ending_.urge(now_, seen_ ? &*seen_ : nullptr);
      if (urge != Urge::kNone) return {urge, now_ - begin_};
    }
    return {};
  }
  void is_seen(messages::NodeState state, bool lost = false) {
    seen_.emplace();
    seen_->status.state = state;
    seen_->lost = lost;
    seen_->seen = begin_;
  }

  const Clock::time_point begin_ = Clock::time_point(100s);
  Clock::time_point now_ = begin_;
  std::optional<messages::SeenStatus> seen_;
  NodeEnding ending_{begin_};
};

TEST_F(NodeEndingTest, ANodeThatNobodyHasHeardOfEndsWithinTwoSeconds) {
  const Deed first = first_deed(2s);
  EXPECT_EQ(first.urge, Urge::kTerminate);
  EXPECT_LE(first.after, 1s);
  const Deed second = first_deed(2s);
  EXPECT_EQ(second.urge, Urge::kKill);
}

TEST_F(NodeEndingTest, ASlowWorldIsLeftToReachTheStateInWhichAllStop) {
  is_seen(messages::NodeState::kRunning);
  EXPECT_EQ(first_deed(20s, 1).urge, Urge::kNone);
}

/// A node of 80 publishes its state every 800 ms. A step that has not grown meanwhile says nothing.
TEST_F(NodeEndingTest, ASlowWorldOfManyNodesIsLeftToReachItToo) {
  is_seen(messages::NodeState::kRunning);
  ending_ = NodeEnding(begin_, 80);
  for (int status = 0; status < 20; ++status) {
    ++seen_->status.step;
    EXPECT_EQ(first_deed(status * 800ms).urge, Urge::kNone);
  }
}

TEST_F(NodeEndingTest, OneThatStandsStillIsToldOnceAndThenWaitedFor) {
  is_seen(messages::NodeState::kRunning);
  EXPECT_EQ(first_deed(2s).urge, Urge::kTerminate);
  EXPECT_EQ(first_deed(29s).urge, Urge::kNone);
}

TEST_F(NodeEndingTest, OneThatWritesItsReportIsLeftInPeaceEvenIfItIsNotHeard) {
  is_seen(messages::NodeState::kFinished, true);
  EXPECT_EQ(first_deed(29s).urge, Urge::kNone);
}

TEST_F(NodeEndingTest, SilenceIsWaitedOutForThreeSeconds) {
  is_seen(messages::NodeState::kRunning, true);
  EXPECT_EQ(first_deed(3s).urge, Urge::kTerminate);
  const Deed deed = first_deed(29s);
  EXPECT_EQ(deed.urge, Urge::kKill);
  EXPECT_GT(deed.after, 3s);
  EXPECT_LE(deed.after, 3500ms);
}

TEST_F(NodeEndingTest, NobodyIsWaitedForForEver) {
  is_seen(messages::NodeState::kFinished);
  EXPECT_EQ(first_deed(40s).urge, Urge::kKill);
}

}  // namespace
}  // namespace aurasim::process
