// To which state all go back when a node has died, from what the nodes say of themselves.
#include "process/restore_plan.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using core::RegionId;
using core::Step;
using messages::NodeState;

class RestorePlans : public ::testing::Test {
 protected:
  /// Stands, with its own parts of these states.
  messages::Status& survivor(std::uint32_t region, std::initializer_list<Step> own, core::Generation era = 0) {
    messages::SeenStatus& seen = nodes_[RegionId{region}];
    seen.status.region = RegionId{region};
    seen.status.process = 100 + region;
    seen.status.state = NodeState::kRecovering;
    seen.status.era = seen.status.generation = era;
    for (const Step step : own) keeps(region, region, step);
    return seen.status;
  }
  void keeps(std::uint32_t region, std::uint32_t whose, Step step) {
    nodes_[RegionId{region}].status.parts.push_back({RegionId{whose}, step});
  }
  void takes_over(std::uint32_t region) {
    messages::SeenStatus& seen = nodes_[RegionId{region}];
    seen.status.region = RegionId{region};
    seen.status.process = 200 + region;
    seen.status.state = NodeState::kSpare;
  }
  std::optional<RestorePlan> plan(std::size_t regions = 3) { return plan_restore(nodes_, regions); }

  std::map<RegionId, messages::SeenStatus> nodes_;
};

TEST_F(RestorePlans, NobodyGoesBackBeforeEveryRegionHasSomebodyWhoStands) {
  survivor(0, {60});
  survivor(1, {60});
  keeps(1, 2, 60);
  EXPECT_FALSE(plan()) << "nobody is there for region 2";
  takes_over(2);
  nodes_[RegionId{2}].lost = true;
  EXPECT_FALSE(plan());
  nodes_[RegionId{2}].lost = false;
  EXPECT_TRUE(plan());
  nodes_[RegionId{1}].status.state = NodeState::kRunning;
  EXPECT_FALSE(plan()) << "it still computes";
}

TEST_F(RestorePlans, NobodyGoesBackBeforeAllHearAll) {
  survivor(0, {60});
  survivor(1, {60});
  survivor(2, {60}).dead = {RegionId{1}};
  EXPECT_FALSE(plan()) << "region 2 does not hear region 1, and would wait for it in vain";
  nodes_[RegionId{2}].status.dead.clear();
  EXPECT_TRUE(plan());
}

TEST_F(RestorePlans, PartsOfWhoHasComeToTakeOverCountLikeOthers) {
  survivor(0, {60, 120});
  survivor(1, {60, 120});
  takes_over(2);
  keeps(2, 2, 120);
  keeps(0, 2, 60);
  const auto made = plan();
  ASSERT_TRUE(made);
  EXPECT_EQ(made->command.at_step, 120);
  EXPECT_EQ(made->command.members[2].holder, RegionId{2}) << "found on its disk";
  EXPECT_FALSE(made->command.members[2].survives);
}

TEST_F(RestorePlans, TheNewestStateWhosePartsAreAllThere) {
  survivor(0, {60, 120, 180});
  survivor(1, {60, 120, 180});
  takes_over(2);
  keeps(0, 2, 60);
  keeps(0, 2, 120);
  const auto made = plan();
  ASSERT_TRUE(made);
  EXPECT_EQ(made->lead, RegionId{0});
  const messages::RunCommand& command = made->command;
  EXPECT_EQ(command.at_step, 120);
  EXPECT_EQ(command.count, 0);
  EXPECT_EQ(command.generation, 1U);
  ASSERT_EQ(command.members.size(), 3U);
  EXPECT_EQ(command.members[1].holder, RegionId{1}) << "its own";
  EXPECT_EQ(command.members[2].holder, RegionId{0}) << "who keeps the dead one's";
  EXPECT_EQ(command.members[2].process, 202U);
  EXPECT_TRUE(command.members[1].survives);
  EXPECT_FALSE(command.members[2].survives);
}

TEST_F(RestorePlans, FromTheFirstStateWhereAPartIsGone) {
  survivor(1, {60, 120});
  survivor(2, {60, 120});
  takes_over(0);
  const auto made = plan();
  ASSERT_TRUE(made);
  EXPECT_EQ(made->lead, RegionId{1}) << "who takes over knows nothing";
  EXPECT_EQ(made->command.count, 1);
}

TEST_F(RestorePlans, PartsOfAnEarlierSceneDoNotFit) {
  survivor(0, {60});
  survivor(1, {60}, 2);  // has begun the new scene; the other one had not heard of it
  takes_over(2);
  keeps(1, 2, 60);
  const auto made = plan();
  ASSERT_TRUE(made);
  EXPECT_EQ(made->lead, RegionId{1});
  EXPECT_EQ(made->command.era, 2U);
  EXPECT_EQ(made->command.generation, 3U);
  EXPECT_EQ(made->command.count, 1);
  EXPECT_FALSE(made->command.members[0].survives) << "its orders are of the scene before";
}

TEST_F(RestorePlans, NobodyKnowsAnything) {
  for (std::uint32_t region = 0; region < 3; ++region) takes_over(region);
  EXPECT_FALSE(plan());
}

}  // namespace
}  // namespace aurasim::process
