// When orders about the run as a whole are due, and what a change that fails leaves behind.
#include "process/run_changes.h"

#include <gtest/gtest.h>

#include "config/workspace.h"

namespace aurasim::process {
namespace {

class RunChangesTest : public ::testing::Test {
 protected:
  void add(const core::Action& action, core::Step at_step) {
    core::Order order;
    order.action = action;
    order.at_step = at_step;
    changes_.add(std::vector<core::Order>{order});
  }
  config::Launch launch() {
    return workspace_.launch("scene: scene.yaml\nregions: {layout: columns, count: 1, width: 40}\n");
  }

  config::Workspace workspace_;
  RunChanges changes_;
};

TEST_F(RunChangesTest, AChangeIsDueOnceItsStateIsConfirmed) {
  add(core::ChangeScene{"tower"}, 10);
  EXPECT_EQ(changes_.states_to_keep(), std::vector<core::Step>{10});
  EXPECT_FALSE(changes_.is_about_to_change(9));
  EXPECT_TRUE(changes_.take_reached(9, 9).empty());
  EXPECT_TRUE(changes_.is_about_to_change(10)) << "an order given now would be lost";
  EXPECT_TRUE(changes_.take_reached(12, 9).empty()) << "not confirmed";
  EXPECT_FALSE(changes_.is_due());
  EXPECT_EQ(changes_.take_reached(12, 10), std::vector<core::Step>{10});
  EXPECT_TRUE(changes_.is_due());
  EXPECT_FALSE(changes_.is_about_to_change(12));
  const core::Order order = changes_.begin({launch(), {}});
  EXPECT_TRUE(std::holds_alternative<core::ChangeScene>(order.action));
  EXPECT_FALSE(changes_.is_due());
}

TEST_F(RunChangesTest, OtherOrdersOfTheRunChangeNothing) {
  add(core::Save{"a.cut"}, 10);
  EXPECT_TRUE(changes_.states_to_keep().empty());
  EXPECT_FALSE(changes_.is_about_to_change(20));
  EXPECT_TRUE(changes_.take_reached(20, 20).empty());
  EXPECT_FALSE(changes_.is_due());
}

TEST_F(RunChangesTest, AnotherWorldDropsOrdersThatWait) {
  add(core::ChangeScene{"tower"}, 10);
  changes_.begin_world();
  EXPECT_TRUE(changes_.take_reached(10, 10).empty());
}

TEST_F(RunChangesTest, ARecoveryGetsBackWhatAChangeHadReplaced) {
  EXPECT_FALSE(changes_.drop()) << "no change is under way";
  add(core::ChangeScene{"tower"}, 10);
  add(core::Load{"a.cut"}, 12);
  changes_.take_reached(10, 10);
  const auto world = std::make_shared<core::WorldCut>();
  changes_.begin({launch(), world});
  const auto before = changes_.drop();
  ASSERT_TRUE(before);
  EXPECT_EQ(before->world, world);
  EXPECT_TRUE(changes_.take_reached(20, 20).empty()) << "the client has to ask again";
  EXPECT_FALSE(changes_.drop());
}

TEST_F(RunChangesTest, ARecoveryDropsAChangeThatWasDue) {
  add(core::ChangeScene{"tower"}, 10);
  changes_.take_reached(10, 10);
  EXPECT_FALSE(changes_.drop());
  EXPECT_FALSE(changes_.is_due());
}

TEST_F(RunChangesTest, AChangeThatSucceedsLeavesNothingToGoBackTo) {
  add(core::ChangeScene{"tower"}, 10);
  changes_.take_reached(10, 10);
  changes_.begin({launch(), {}});
  changes_.finish();
  EXPECT_FALSE(changes_.drop());
}

TEST_F(RunChangesTest, IsTriedThreeTimesInARow) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(changes_.may_try_again());
  EXPECT_FALSE(changes_.may_try_again());
  changes_.finish();
  EXPECT_TRUE(changes_.may_try_again()) << "a success between";
}

TEST(AllWaitIn, TheStateOfTheChangeOnceEachOtherNodeIsThereOrPastIt) {
  std::map<core::RegionId, messages::SeenStatus> nodes;
  for (std::uint32_t region = 0; region < 3; ++region) {
    nodes[core::RegionId{region}].status.state = messages::NodeState::kPaused;
    nodes[core::RegionId{region}].status.generation = 2;
    nodes[core::RegionId{region}].status.step = 40;
  }
  const auto all_wait = [&] { return all_wait_in(nodes, core::RegionId{0}, 2, 40); };
  EXPECT_TRUE(all_wait());
  messages::Status& other = nodes[core::RegionId{2}].status;
  other.step = 39;
  EXPECT_FALSE(all_wait());
  other.step = 41;
  EXPECT_TRUE(all_wait());
  other.state = messages::NodeState::kRunning;
  EXPECT_FALSE(all_wait());
  other.generation = 3;
  other.step = 0;
  EXPECT_TRUE(all_wait()) << "it has gone on, so it was there";
  nodes[core::RegionId{0}].status.state = messages::NodeState::kRunning;
  EXPECT_TRUE(all_wait()) << "this node's own status may be old";
}

}  // namespace
}  // namespace aurasim::process
