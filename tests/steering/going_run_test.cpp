// A node that is started again waits as a spare if the run goes on without it, and begins it with the others if not.
#include "steering/going_run.h"

#include <gtest/gtest.h>

namespace aurasim::steering {
namespace {

using messages::NodeState;

messages::SeenStatus node_in(NodeState state) {
  messages::SeenStatus seen;
  seen.status.state = state;
  return seen;
}

messages::SeenStatus lost(messages::SeenStatus seen) {
  seen.lost = true;
  return seen;
}

TEST(GoingRun, NobodyIsNoRun) { EXPECT_FALSE(goes_on({})); }

TEST(GoingRun, NodesThatWaitForEachOtherHaveNotBegun) {
  EXPECT_FALSE(
      goes_on({{core::RegionId{0}, node_in(NodeState::kWaiting)}, {core::RegionId{3}, node_in(NodeState::kStarting)}}));
}

TEST(GoingRun, OneNodeThatRunsIsEnough) {
  EXPECT_TRUE(
      goes_on({{core::RegionId{0}, node_in(NodeState::kWaiting)}, {core::RegionId{1}, node_in(NodeState::kRunning)}}));
}

TEST(GoingRun, WhoStandsBecauseOfADeathIsToBeHelped) {
  EXPECT_TRUE(goes_on({{core::RegionId{1}, node_in(NodeState::kRecovering)}}));
  EXPECT_TRUE(goes_on({{core::RegionId{1}, node_in(NodeState::kPaused)}}));
}

TEST(GoingRun, TheDeadAndThoseThatHaveEndedAreNoRun) {
  EXPECT_FALSE(goes_on({{core::RegionId{0}, lost(node_in(NodeState::kRunning))},
                        {core::RegionId{1}, node_in(NodeState::kFinished)},
                        {core::RegionId{2}, node_in(NodeState::kFailed)}}));
}

}  // namespace
}  // namespace aurasim::steering
