// How long a node stays after its last state.
#include "process/lingering.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using core::RegionId;
using messages::NodeState;

class LingeringTest : public ::testing::Test {
 protected:
  static constexpr Lingering::Clock::time_point kEnd{100s};

  LingeringTest() { see(0, NodeState::kRunning, 500, 0ms); }

  /// Region `region` has published this status at `time` after the end.
  void see(std::uint32_t region, NodeState state, core::Step step, std::chrono::milliseconds time) {
    messages::SeenStatus& seen = nodes_[RegionId{region}];
    seen.status.region = RegionId{region};
    seen.status.state = state;
    seen.status.step = step;
    seen.seen = kEnd + time;
  }
  bool stays(std::chrono::milliseconds time, bool is_complete = false, bool is_stopped = false) {
    return lingering_.stays(nodes_, is_complete, is_stopped, kEnd + time);
  }

  Lingering lingering_{RegionId{1}, kEnd};
  SeenNodes nodes_;
};

TEST_F(LingeringTest, EndsAtOnceWhenNobodyNeedsAnythingAnyMore) {
  EXPECT_TRUE(stays(0ms));
  EXPECT_FALSE(stays(0ms, true));
}

TEST_F(LingeringTest, StaysAMomentForThoseThatMayNeedItsLastMessages) {
  nodes_.clear();
  EXPECT_TRUE(stays(1499ms, false, true)) << "even when it is told to stop";
  EXPECT_FALSE(stays(1500ms));
}

TEST_F(LingeringTest, StaysAsLongAsAnotherNodeGoesOn) {
  for (int second = 1; second < 100; ++second) {
    see(0, NodeState::kRunning, 500 + second, std::chrono::seconds(second));
    EXPECT_TRUE(stays(std::chrono::seconds(second)));
  }
  EXPECT_FALSE(stays(100s, false, true)) << "told to stop";
}

TEST_F(LingeringTest, DoesNotStayForANodeThatMakesNoProgress) {
  for (int second = 1; second <= 31; ++second) {
    see(0, NodeState::kPaused, 500, std::chrono::seconds(second));
    EXPECT_TRUE(stays(std::chrono::seconds(second)));
  }
  see(0, NodeState::kPaused, 500, 40s);
  EXPECT_FALSE(stays(40s));
}

TEST_F(LingeringTest, ANodeThatComputesOneStepForLongMakesProgress) {
  EXPECT_TRUE(stays(2s));
  EXPECT_TRUE(stays(60s)) << "it has published nothing for a minute, and its process lives";
}

TEST_F(LingeringTest, DoesNotStayForADeadNode) {
  EXPECT_TRUE(stays(2s));
  nodes_[RegionId{0}].lost = true;
  EXPECT_FALSE(stays(3s));
}

TEST_F(LingeringTest, AllHaveLeftOnceEachOtherNodeHasEndedOrIsSilent) {
  see(2, NodeState::kRunning, 400, 0ms);
  EXPECT_FALSE(all_have_left(nodes_, RegionId{1}, {}));
  see(0, NodeState::kFinished, 600, 0ms);
  EXPECT_FALSE(all_have_left(nodes_, RegionId{1}, {}));
  EXPECT_TRUE(all_have_left(nodes_, RegionId{1}, {RegionId{2}})) << "its last status may be lost";
  EXPECT_TRUE(all_have_left(nodes_, RegionId{2}, {})) << "a node does not wait for itself";
  nodes_[RegionId{2}].lost = true;
  EXPECT_TRUE(all_have_left(nodes_, RegionId{1}, {}));
  nodes_[RegionId{2}].dead = true;
  EXPECT_FALSE(all_have_left(nodes_, RegionId{1}, {})) << "it has died, and is to be replaced";
}

}  // namespace
}  // namespace aurasim::process
