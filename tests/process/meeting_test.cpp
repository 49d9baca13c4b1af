// Tests of what a node decides while it meets the others of its run.
#include "process/meeting.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using core::RegionId;
using messages::NodeState;

messages::SeenStatus node_in(std::uint32_t region, NodeState state, core::Generation generation = 0) {
  messages::SeenStatus seen;
  seen.status.region = RegionId{region};
  seen.status.state = state;
  seen.status.generation = generation;
  seen.status.pid = 100 + region;
  return seen;
}

OwnRun own_run() { return {RegionId{1}, 50, 7, 3, 0, 14, "demo", 4}; }

messages::WorldMap map_with(std::uint64_t agreement, core::Step from_step) {
  messages::WorldMap map;
  map.agreement = agreement;
  map.from_step = from_step;
  map.scene = "tower";
  return map;
}

TEST(Meeting, AnEmptyDomainIsFree) {
  EXPECT_EQ(refusal_of_maps({}, own_run()), "");
  EXPECT_EQ(refusal_of_strangers({}, own_run(), false), "");
}

TEST(Meeting, TheMapOfOnesOwnRunIsNoReasonToRefuse) {
  EXPECT_EQ(refusal_of_maps({{3, map_with(7, 0)}}, own_run()), "");
}

TEST(Meeting, AMapOfAnotherRunIsNamedWithBothScenes) {
  const std::string why = refusal_of_maps({{3, map_with(7, 0)}, {4, map_with(8, 0)}}, own_run());
  EXPECT_NE(why.find("DDS domain 14 already has a run that does not agree"), std::string::npos) << why;
  EXPECT_NE(why.find("scene 'tower'"), std::string::npos) << why;
  EXPECT_NE(why.find("this is scene 'demo', 4 regions"), std::string::npos) << why;
}

TEST(Meeting, ARunThatBeginsWithAnotherStateIsRefused) {
  const std::string why = refusal_of_maps({{3, map_with(7, 60)}}, own_run());
  EXPECT_NE(why.find("it begins with state 60; this one with state 0"), std::string::npos) << why;
}

TEST(Meeting, OfTwoThatBeginTogetherTheOneWithTheLowerNumberStays) {
  messages::SeenStatus other = node_in(1, NodeState::kStarting);
  other.status.agreement = 7;
  other.status.run = 60;
  EXPECT_NE(refusal_of_strangers({other}, own_run(), false), "") << "nothing is published yet, so nothing is lost";
  EXPECT_EQ(refusal_of_strangers({other}, own_run(), true), "");
  other.status.run = 40;
  EXPECT_NE(refusal_of_strangers({other}, own_run(), true), "");
  other.status.run = 60;
  other.status.state = NodeState::kRunning;
  EXPECT_NE(refusal_of_strangers({other}, own_run(), true), "") << "it runs already";
  other.status.agreement = 8;
  EXPECT_EQ(refusal_of_strangers({other}, own_run(), true), "") << "its map says more";
}

TEST(Meeting, ItsProgressGrowsWithEachNodeThatComesAndThatWaits) {
  SeenNodes nodes = {{RegionId{0}, node_in(0, NodeState::kStarting)}};
  EXPECT_EQ(progress_of_meeting(nodes, 5), 6U);
  nodes[RegionId{2}] = node_in(2, NodeState::kWaiting);
  EXPECT_EQ(progress_of_meeting(nodes, 5), 8U);
  EXPECT_DOUBLE_EQ(share_of_nodes(nodes, RegionId{1}, 4), 0.75) << "this node is there, whether it is heard or not";
  nodes[RegionId{1}] = node_in(1, NodeState::kWaiting);
  EXPECT_DOUBLE_EQ(share_of_nodes(nodes, RegionId{1}, 4), 0.75);
}

TEST(Meeting, NodesThatDoNotWaitAreNamedByWhatTheyDo) {
  const SeenNodes nodes = {{RegionId{0}, node_in(0, NodeState::kWaiting)},
                           {RegionId{2}, node_in(2, NodeState::kStarting)}};
  EXPECT_EQ(who_does_not_wait(nodes, 4),
            "regions that have not reported: [1, 3]; regions that still look for their neighbours: [2]");
}

TEST(Meeting, AClockThatLooksBehindIsNamedOnlyAcrossHosts) {
  SeenNodes nodes = {{RegionId{0}, node_in(0, NodeState::kWaiting)}, {RegionId{2}, node_in(2, NodeState::kWaiting)}};
  nodes[RegionId{0}].clock_ahead = -2s;
  EXPECT_TRUE(wrong_clocks(nodes, true).empty());
  ASSERT_EQ(wrong_clocks(nodes, false).size(), 1U);
  EXPECT_NE(wrong_clocks(nodes, false)[0].find("region 0's host is 2.0 s behind"), std::string::npos);
  nodes[RegionId{2}].clock_ahead = 3s;
  EXPECT_EQ(wrong_clocks(nodes, true).size(), 1U);
}

TEST(Meeting, TheClockDifferenceIsThatOfTheFastestMessage) {
  SeenNodes nodes = {{RegionId{0}, node_in(0, NodeState::kRunning)}};
  nodes[RegionId{0}].clock_ahead = 30ms;
  messages::RunCommand command;
  command.clock_ahead = -1s;
  EXPECT_EQ(with_clock_of(nodes, RegionId{0}, command).clock_ahead, 30ms);
  EXPECT_EQ(with_clock_of(nodes, RegionId{5}, command).clock_ahead, -1s);
}

TEST(AwaitedStart, RegionZeroSendsItOnceAllOthersWaitForThisGeneration) {
  AwaitedStart start(RegionId{0}, 3);
  start.await(2);
  SeenNodes nodes = {{RegionId{0}, node_in(0, NodeState::kWaiting, 2)},
                     {RegionId{1}, node_in(1, NodeState::kWaiting, 2)}};
  EXPECT_FALSE(start.to_send(nodes, 9, 1000)) << "region 2 is missing, and region 0 does not count twice";
  nodes[RegionId{2}] = node_in(2, NodeState::kWaiting, 1);
  EXPECT_FALSE(start.to_send(nodes, 9, 1000)) << "it waits for another generation";
  nodes[RegionId{2}].status.generation = 2;
  const auto command = start.to_send(nodes, 9, 1000);
  ASSERT_TRUE(command);
  EXPECT_EQ(command->kind, messages::RunCommandKind::kStart);
  EXPECT_EQ(command->generation, 2U);
  EXPECT_EQ(command->run, 9U);
  EXPECT_EQ(command->epoch_ns, 500'001'000);
  start.accept(*command);
  EXPECT_FALSE(start.to_send(nodes, 9, 1000)) << "it is sent already";
  EXPECT_FALSE(AwaitedStart(RegionId{1}, 1).to_send(nodes, 9, 1000)) << "only region 0 sends it";
}

TEST(AwaitedStart, OnlyThatOfTheAwaitedGenerationIsAccepted) {
  AwaitedStart start(RegionId{1}, 3);
  start.await(2);
  messages::RunCommand command;
  command.generation = 1;
  EXPECT_FALSE(start.is_awaited(command));
  command.generation = 2;
  EXPECT_TRUE(start.is_awaited(command));
  start.accept(command);
  EXPECT_FALSE(start.is_awaited(command)) << "one is here already";
  start.await(3);
  EXPECT_TRUE(start.start()) << "the last one counts until it is forgotten";
  start.forget();
  EXPECT_FALSE(start.start());
}

TEST(EarlyDeaths, AreNamedOnceEachTime) {
  EarlyDeaths deaths;
  SeenNodes nodes = {{RegionId{2}, node_in(2, NodeState::kWaiting)}};
  EXPECT_TRUE(deaths.look(nodes).empty());
  nodes[RegionId{2}].lost = true;
  ASSERT_EQ(deaths.look(nodes),
            std::vector<std::string>{"the node of region 2 (process 102) has died before the run has begun"});
  EXPECT_TRUE(deaths.look(nodes).empty());
  nodes[RegionId{2}].lost = false;
  EXPECT_TRUE(deaths.look(nodes).empty());
  nodes[RegionId{2}].status.state = NodeState::kFailed;
  ASSERT_EQ(deaths.look(nodes).size(), 1U);
}

TEST(EarlyDeaths, ANodeThatHasFinishedAShortRunIsNone) {
  EarlyDeaths deaths;
  EXPECT_TRUE(deaths.look({{RegionId{2}, node_in(2, NodeState::kFinished)}}).empty());
}

}  // namespace
}  // namespace aurasim::process
