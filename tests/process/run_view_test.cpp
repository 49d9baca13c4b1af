// Tests of who leads a run, and of what the lead sees of it.
#include "process/run_view.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using core::RegionId;

class RunViewTest : public ::testing::Test {
 protected:
  RunViewTest() {
    for (std::uint32_t region = 0; region < 3; ++region) {
      messages::SeenStatus& seen = nodes_[RegionId{region}];
      seen.status.region = RegionId{region};
      seen.status.state = messages::NodeState::kRunning;
      seen.status.agreement = 7;
      seen.status.bodies = 10;
    }
  }
  RunView view_of(std::uint32_t region) const { return view_of_run(nodes_, nodes_.at(RegionId{region}).status, {}); }

  SeenNodes nodes_;
};

TEST_F(RunViewTest, TheLiveNodeOfTheLowestRegionLeads) {
  EXPECT_TRUE(view_of(0).leads);
  EXPECT_FALSE(view_of(1).leads);
  nodes_[RegionId{0}].lost = true;
  EXPECT_TRUE(view_of(1).leads);
  EXPECT_FALSE(view_of(2).leads);
}

TEST_F(RunViewTest, ARunWithADeadNodeIsNotComplete) {
  EXPECT_TRUE(view_of(0).facts.complete);
  EXPECT_EQ(view_of(0).facts.bodies, 30U);
  nodes_[RegionId{2}].lost = true;
  EXPECT_FALSE(view_of(0).facts.complete);
  EXPECT_EQ(view_of(0).facts.bodies, 20U);
}

TEST_F(RunViewTest, NodesOfAnotherRunDoNotCount) {
  nodes_[RegionId{0}].status.agreement = 8;
  EXPECT_TRUE(view_of(1).leads);
  EXPECT_EQ(view_of(1).facts.bodies, 20U);
  EXPECT_TRUE(view_of(1).facts.complete);
}

TEST_F(RunViewTest, NamesTheLiveRegionsThatLackAMesh) {
  nodes_[RegionId{1}].status.meshes = {5};
  const RunView view = view_of(0);
  EXPECT_EQ(view.lacking(5), (std::vector<RegionId>{RegionId{0}, RegionId{2}}));
  nodes_[RegionId{2}].lost = true;
  EXPECT_EQ(view.lacking(5), std::vector<RegionId>{RegionId{0}});
}

}  // namespace
}  // namespace aurasim::process
