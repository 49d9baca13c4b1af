// When a node may leave its region to another process.
#include "process/leaving.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using core::RegionId;
using messages::NodeState;

class LeavingTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kSelf = 11;

  LeavingTest() {
    for (std::uint32_t region = 0; region < 3; ++region) {
      messages::SeenStatus seen;
      seen.status.region = RegionId{region};
      seen.status.process = 10 + region;
      seen.status.state = NodeState::kRunning;
      nodes_[RegionId{region}] = seen;
    }
  }
  messages::RunCommand drain(std::uint32_t region, std::uint64_t process) const {
    messages::RunCommand command;
    command.kind = messages::RunCommandKind::kDrain;
    command.region = RegionId{region};
    command.process = process;
    return command;
  }
  /// Region `owner` keeps the part of `region` in `state`.
  void keep(std::uint32_t owner, std::uint32_t region, core::Step state) {
    if (owner == 1) parts_.push_back({RegionId{region}, state});
    nodes_[RegionId{owner}].status.parts.push_back({RegionId{region}, state});
  }
  bool may_leave(core::Step step, bool is_paused = false, bool has_successor = true) {
    return leaving_.may_leave(has_successor, {step, is_paused, parts_, keepers_}, nodes_);
  }

  Leaving leaving_{RegionId{1}, kSelf};
  SeenNodes nodes_;
  std::vector<messages::KeptPart> parts_;
  std::vector<RegionId> keepers_ = {RegionId{2}};
};

TEST_F(LeavingTest, ADrainThatNamesThisProcessMakesItLeave) {
  EXPECT_FALSE(leaving_.drains());
  EXPECT_TRUE(leaving_.note_drain(drain(1, kSelf), nodes_));
  EXPECT_TRUE(leaving_.drains());
  EXPECT_FALSE(leaving_.note_drain(drain(1, kSelf), nodes_)) << "no news";
}

TEST_F(LeavingTest, ADrainOfAnotherNodeIsNewsAndChangesNothingHere) {
  EXPECT_TRUE(leaving_.note_drain(drain(2, 12), nodes_));
  EXPECT_FALSE(leaving_.drains());
  EXPECT_TRUE(leaving_.processes().contains(12));
}

TEST_F(LeavingTest, ADrainOfAProcessThatIsNotThereIsDropped) {
  EXPECT_FALSE(leaving_.note_drain(drain(1, 99), nodes_)) << "the process that had this region before";
  EXPECT_FALSE(leaving_.note_drain(drain(2, 99), nodes_));
  EXPECT_FALSE(leaving_.note_drain(drain(7, 12), nodes_));
  EXPECT_TRUE(leaving_.processes().empty());
}

TEST_F(LeavingTest, SomebodyHasToStayWithTheWorld) {
  EXPECT_TRUE(leaving_.can_leave_to_others(nodes_));
  leaving_.note_drain(drain(0, 10), nodes_);
  EXPECT_TRUE(leaving_.can_leave_to_others(nodes_));
  nodes_[RegionId{2}].lost = true;
  EXPECT_FALSE(leaving_.can_leave_to_others(nodes_));
}

TEST_F(LeavingTest, LeavesWithoutASuccessorAfterSomeSeconds) {
  const Leaving::Clock::time_point now{};
  EXPECT_FALSE(leaving_.is_overdue(now + 1h)) << "it was not asked to leave";
  leaving_.begin(now);
  EXPECT_TRUE(leaving_.has_begun());
  EXPECT_FALSE(leaving_.is_overdue(now + 20s));
  EXPECT_TRUE(leaving_.is_overdue(now + 21s));
}

TEST_F(LeavingTest, WaitsForAStateThatAllKeepSinceTheSuccessorIsThere) {
  for (const std::uint32_t region : {0U, 1U, 2U}) keep(region, region, 20);
  keep(2, 1, 20);
  EXPECT_FALSE(may_leave(25, false, false)) << "nobody takes the region over";
  EXPECT_FALSE(may_leave(25)) << "state 20 is from before the successor came";
  for (const std::uint32_t region : {0U, 1U, 2U}) keep(region, region, 40);
  EXPECT_FALSE(may_leave(45)) << "the keeper does not have it yet";
  keep(2, 1, 40);
  EXPECT_TRUE(may_leave(46));
}

TEST_F(LeavingTest, DoesNotLeaveWhileAnotherNodeLacksItsOwnPart) {
  EXPECT_FALSE(may_leave(10));
  keep(1, 1, 20);
  keep(2, 1, 20);
  keep(2, 2, 20);
  EXPECT_FALSE(may_leave(25)) << "region 0 does not keep its own part";
  keep(0, 0, 20);
  EXPECT_TRUE(may_leave(26));
}

TEST_F(LeavingTest, APausedRunHasNoNewerStateSoTheLastOneCounts) {
  for (const std::uint32_t region : {0U, 1U, 2U}) keep(region, region, 20);
  keep(2, 1, 20);
  EXPECT_FALSE(may_leave(25));
  EXPECT_TRUE(may_leave(25, true));
}

TEST_F(LeavingTest, ASuccessorIsASpareOfThisRunForThisRegion) {
  messages::Status own;
  own.region = RegionId{1};
  own.run = 5;
  own.agreement = 7;
  messages::SeenStatus spare;
  spare.status = own;
  spare.status.state = NodeState::kSpare;
  EXPECT_TRUE(has_successor({spare}, own));
  spare.status.run = 6;
  EXPECT_FALSE(has_successor({spare}, own));
  spare.status = own;
  EXPECT_FALSE(has_successor({spare}, own)) << "it is no spare";
  EXPECT_FALSE(has_successor({}, own));
}

}  // namespace
}  // namespace aurasim::process
