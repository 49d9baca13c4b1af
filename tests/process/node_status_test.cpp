// When a node's status is due, and what it adds up.
#include "process/node_status.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using core::RegionId;

messages::Status identity_of_region_2() {
  messages::Status status;
  status.region = RegionId{2};
  status.process = 77;
  return status;
}

class NodeStatusTest : public ::testing::Test {
 protected:
  static constexpr std::chrono::steady_clock::time_point kBegin{100s};

  void publish(messages::NodeState state, NodeStatus::Clock::time_point now) { status_.note_published(state, {}, now); }

  NodeStatus status_{identity_of_region_2(), kBegin};
};

TEST_F(NodeStatusTest, IsDueAfterItsPeriodOrWhenTheStateOfTheNodeChanges) {
  EXPECT_TRUE(status_.is_due(messages::NodeState::kStarting, kBegin)) << "the first one";
  publish(messages::NodeState::kRunning, kBegin);
  EXPECT_FALSE(status_.is_due(messages::NodeState::kRunning, kBegin + 99ms));
  EXPECT_TRUE(status_.is_due(messages::NodeState::kRunning, kBegin + 100ms));
  EXPECT_TRUE(status_.is_due(messages::NodeState::kPaused, kBegin + 1ms));
}

TEST_F(NodeStatusTest, IsRarerTheMoreNodesReceiveIt) {
  NodeStatus of_many(identity_of_region_2(), kBegin, 64);
  of_many.note_published(messages::NodeState::kRunning, {}, kBegin);
  EXPECT_FALSE(of_many.is_due(messages::NodeState::kRunning, kBegin + 639ms));
  EXPECT_TRUE(of_many.is_due(messages::NodeState::kRunning, kBegin + 640ms));
}

TEST_F(NodeStatusTest, OfManyNodesComesSoonerWhereOthersWaitForWhatHasChanged) {
  NodeStatus of_many(identity_of_region_2(), kBegin, 64);
  const Awaited before{1, std::nullopt, 0};
  of_many.note_published(messages::NodeState::kRunning, before, kBegin);
  EXPECT_FALSE(of_many.is_awaited(before, kBegin + 200ms)) << "nothing new";
  for (const Awaited& now : {Awaited{2, std::nullopt, 0}, Awaited{1, 7, 0}, Awaited{1, std::nullopt, 7}}) {
    EXPECT_TRUE(of_many.is_awaited(now, kBegin + 100ms));
    EXPECT_FALSE(of_many.is_awaited(now, kBegin + 99ms)) << "not with each state of a client's steps";
  }
}

TEST_F(NodeStatusTest, IsDueAtOnceWhereOthersWaitForIt) {
  publish(messages::NodeState::kRunning, kBegin);
  status_.make_due();
  EXPECT_TRUE(status_.is_due(messages::NodeState::kRunning, kBegin));
}

TEST_F(NodeStatusTest, IsDueAtOnceWhenOtherRegionsAreUnheard) {
  publish(messages::NodeState::kRecovering, kBegin);
  status_.note_unreachable({});
  EXPECT_FALSE(status_.period_is_over(kBegin)) << "as before";
  status_.note_unreachable({RegionId{1}});
  EXPECT_TRUE(status_.period_is_over(kBegin));
  EXPECT_EQ(status_.content().dead, std::vector<RegionId>{RegionId{1}});
}

TEST_F(NodeStatusTest, AddsHandOffsUpAndShowsTheNewestCounts) {
  node::StepReport report;
  report.bodies = 5;
  report.departures.resize(2);
  report.arrivals.resize(1);
  status_.note_step(report, 4, kBegin);
  report.bodies = 4;
  status_.note_step(report, 4, kBegin);
  EXPECT_EQ(status_.content().bodies, 4U);
  EXPECT_EQ(status_.content().hand_offs_out, 4U);
  EXPECT_EQ(status_.content().hand_offs_in, 2U);
}

TEST_F(NodeStatusTest, CountsRefusedMessagesOfStrangersBesideThoseOfNeighbours) {
  status_.content().refused = {{RegionId{1}, 3}};
  status_.note_refused_strangers(5);
  status_.note_refused_strangers(6);
  EXPECT_EQ(status_.content().refused.size(), 2U);
  EXPECT_EQ(status_.refused_of(messages::kNoRegion), 6U);
  EXPECT_EQ(status_.refused_of(RegionId{1}), 3U);
  EXPECT_EQ(status_.refused_of(RegionId{4}), 0U);
  status_.note_refused_strangers(0);
  EXPECT_EQ(status_.content().refused.size(), 1U);
}

TEST_F(NodeStatusTest, AWindowHoldsTheLastSecond) {
  FrameWindow window(kBegin);
  messages::Status status;
  window.note(10, {0.002, 0.001, 0.0005, 0, 0, 0}, kBegin + 10ms);
  window.note(30, {0.004, 0.001, 0.0005, 0, 0, 0}, kBegin + 20ms);
  window.note_exchanges(std::vector<double>{0.0001, 0.0003});
  window.summarize(status);
  EXPECT_DOUBLE_EQ(status.exchange_times.max_ms, 0.3);
  EXPECT_DOUBLE_EQ(status.frame.max_ms, 30);
  EXPECT_DOUBLE_EQ(status.physics.max_ms, 4);
  window.note(5, {0.001, 0, 0, 0, 0, 0}, kBegin + 1001ms);
  window.summarize(status);
  EXPECT_DOUBLE_EQ(status.exchange_times.max_ms, 0) << "no exchange in this second";
  EXPECT_DOUBLE_EQ(status.frame.max_ms, 5);
  EXPECT_DOUBLE_EQ(status.physics.max_ms, 1);
}

}  // namespace
}  // namespace aurasim::process
