// To which state a run goes back when somebody asks for it, from what the nodes say that they keep.
#include "process/step_back.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using core::RegionId;
using core::Step;

class StepsBack : public ::testing::Test {
 protected:
  messages::Status& node(std::uint32_t region, std::initializer_list<Step> own) {
    messages::Status& status = nodes_[RegionId{region}].status;
    status.region = RegionId{region};
    status.process = 100 + region;
    status.state = messages::NodeState::kPaused;
    status.generation = 3;
    status.era = 2;
    status.parts.clear();
    for (const Step step : own) status.parts.push_back({RegionId{region}, step});
    return status;
  }

  std::map<RegionId, messages::SeenStatus> nodes_;
};

TEST_F(StepsBack, GoToTheNewestStateThatAllKeep) {
  node(0, {60, 120, 180, 240});
  node(1, {60, 120, 180});
  const auto back = plan_step_back(nodes_, 2, 1000);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->kind, messages::RunCommandKind::kRestore);
  EXPECT_EQ(back->at_step, 180);
  EXPECT_EQ(back->generation, 4U);
  EXPECT_EQ(back->era, 2U);
  EXPECT_EQ(back->count, 0) << "not from the first state";
  ASSERT_EQ(back->members.size(), 2U);
  EXPECT_EQ(back->members[1].process, 101U);
  EXPECT_EQ(back->members[1].holder, RegionId{1});
  EXPECT_FALSE(back->members[1].survives) << "orders given since are forgotten";
}

TEST_F(StepsBack, GoFartherEachTime) {
  node(0, {60, 120, 180});
  node(1, {60, 120, 180});
  EXPECT_EQ(plan_step_back(nodes_, 2, 179)->at_step, 120);
  EXPECT_EQ(plan_step_back(nodes_, 2, 119)->at_step, 60);
  EXPECT_FALSE(plan_step_back(nodes_, 2, 59));
}

TEST_F(StepsBack, AreForARunThatIsWhole) {
  node(0, {60});
  EXPECT_FALSE(plan_step_back(nodes_, 2, 100)) << "region 1 is not there";
  node(1, {60});
  EXPECT_TRUE(plan_step_back(nodes_, 2, 100));
  node(1, {60}).state = messages::NodeState::kRecovering;
  EXPECT_FALSE(plan_step_back(nodes_, 2, 100));
  node(1, {60}).era = 1;
  EXPECT_FALSE(plan_step_back(nodes_, 2, 100));
  node(1, {60}).generation = 2;
  EXPECT_FALSE(plan_step_back(nodes_, 2, 100));
  node(1, {60});
  nodes_[RegionId{1}].lost = true;
  EXPECT_FALSE(plan_step_back(nodes_, 2, 100));
  nodes_[RegionId{1}].lost = false;
  node(1, {}).parts.push_back({RegionId{0}, 60});
  EXPECT_FALSE(plan_step_back(nodes_, 2, 100)) << "it keeps another region's part, and not its own";
}

}  // namespace
}  // namespace aurasim::process
