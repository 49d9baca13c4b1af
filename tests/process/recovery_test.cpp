// What a node decides while it stands. Time is made up.
#include "process/recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using core::RegionId;
using messages::NodeState;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

class Standing : public ::testing::Test {
 protected:
  void hear(std::uint32_t region, NodeState state = NodeState::kRecovering) {
    messages::SeenStatus& seen = nodes_[RegionId{region}];
    seen.lost = false;
    seen.status.region = RegionId{region};
    seen.status.process = 100 + region;
    seen.status.state = state;
  }
  void lose(std::uint32_t region) { nodes_[RegionId{region}].lost = true; }
  void does_not_hear(std::uint32_t region, std::vector<RegionId> others) {
    nodes_[RegionId{region}].status.dead = std::move(others);
  }
  Recovery recovery_of(std::uint32_t region, bool has_launcher = false) {
    Recovery recovery({RegionId{region}, 4, 20s, true, has_launcher, 60});
    recovery.begin(now_);
    return recovery;
  }
  RecoveryActs look(Recovery& recovery, std::uint32_t region, bool may_go_on = true, bool is_cut_off = false) {
    return recovery.look({nodes_, leaving_, 100 + region, true, may_go_on, is_cut_off, 300}, now_);
  }

  SeenNodes nodes_;
  std::set<std::uint64_t> leaving_;
  Recovery::Clock::time_point now_{1h};
};

TEST_F(Standing, ARegionThatSomebodyHearsIsNotVacant) {
  Recovery recovery = recovery_of(0);
  for (const std::uint32_t region : {0U, 1U, 2U, 3U}) hear(region);
  lose(1);
  EXPECT_THAT(look(recovery, 0).vacant, IsEmpty()) << "regions 2 and 3 hear it";
  does_not_hear(2, {RegionId{1}});
  EXPECT_THAT(look(recovery, 0).vacant, IsEmpty());
  does_not_hear(3, {RegionId{1}});
  EXPECT_THAT(look(recovery, 0).vacant, ElementsAre(RegionId{1}));
}

TEST_F(Standing, ANodeThatIsCutOffAndHeardIsGivenTimeToHearTheOthers) {
  Recovery recovery = recovery_of(0);
  for (const std::uint32_t region : {0U, 1U, 2U, 3U}) hear(region);
  hear(2, NodeState::kCutOff);
  EXPECT_THAT(look(recovery, 0).vacant, IsEmpty());
  now_ += 4s;
  EXPECT_THAT(look(recovery, 0).vacant, IsEmpty());
  now_ += 2s;
  EXPECT_THAT(look(recovery, 0).vacant, ElementsAre(RegionId{2})) << "only one direction of its link works";
  hear(2);
  EXPECT_THAT(look(recovery, 0).vacant, IsEmpty());
}

TEST_F(Standing, TheNextRegionsHostStandsInAfterAWhile) {
  for (const std::uint32_t region : {0U, 1U, 3U}) hear(region);
  Recovery third = recovery_of(3), first = recovery_of(0);
  for (const std::uint32_t region : {0U, 1U, 3U}) does_not_hear(region, {RegionId{2}});
  look(third, 3);
  look(first, 0);
  now_ += 21s;
  EXPECT_THAT(look(third, 3).stand_ins, ElementsAre(RegionId{2}));
  EXPECT_THAT(look(first, 0).stand_ins, IsEmpty());
  EXPECT_THAT(look(third, 3).stand_ins, IsEmpty()) << "it has just begun";
}

TEST_F(Standing, WhoHasGivenUpSaysWhyToThoseWhoStandForIt) {
  OwnWorld own;
  own.region = RegionId{0};
  hear(1, NodeState::kFailed);
  nodes_[RegionId{1}].status.text = "the node of region 2 has died";
  EXPECT_EQ(why_stand(nodes_, own), "the node of region 1 has given up: the node of region 2 has died");
  nodes_[RegionId{1}].status.text.clear();
  EXPECT_EQ(why_stand(nodes_, own), "the node of region 1 has given up");
}

TEST_F(Standing, ACoupledNodeStandsForOneThatHasEndedBefore) {
  OwnWorld own;
  own.region = RegionId{0};
  hear(1, NodeState::kFinished);
  nodes_[RegionId{1}].status.step = 121;
  EXPECT_EQ(why_stand(nodes_, own), std::nullopt) << "with auras the others go on";
  own.coupled_in = 120;
  EXPECT_EQ(why_stand(nodes_, own), std::nullopt) << "its part of state 121 is on the way";
  own.coupled_in = 121;
  EXPECT_EQ(why_stand(nodes_, own), "the node of region 1 has ended");
}

/// Its host starts three processes for the region, one after the other. All of them die where the node has died.
TEST_F(Standing, WhoHasStoodInThreeTimesInVainGivesUp) {
  for (const std::uint32_t region : {0U, 1U, 3U}) hear(region);
  for (const std::uint32_t region : {0U, 1U, 3U}) does_not_hear(region, {RegionId{2}});
  Recovery recovery = recovery_of(3);
  look(recovery, 3);
  for (int i = 0; i < 3; ++i) {
    now_ += 21s;
    const RecoveryActs acts = look(recovery, 3);
    EXPECT_THAT(acts.stand_ins, ElementsAre(RegionId{2}));
    EXPECT_FALSE(acts.gives_up);
  }
  now_ += 21s;
  const RecoveryActs acts = look(recovery, 3);
  EXPECT_TRUE(acts.gives_up);
  EXPECT_THAT(acts.stand_ins, IsEmpty());
  EXPECT_THAT(acts.vacant, ElementsAre(RegionId{2})) << "the message names it";
}

TEST_F(Standing, BelowALauncherThatStartsNobodyTheNodesGiveUpAfterTheirPatience) {
  for (const std::uint32_t region : {0U, 1U, 3U}) hear(region);
  for (const std::uint32_t region : {0U, 1U, 3U}) does_not_hear(region, {RegionId{2}});
  Recovery recovery = recovery_of(0, true);
  look(recovery, 0);
  now_ += 19s;
  EXPECT_FALSE(look(recovery, 0).gives_up);
  now_ += 2s;
  EXPECT_TRUE(look(recovery, 0).gives_up);
}

TEST_F(Standing, NobodyStandsInForOthersWithoutTheMajority) {
  Recovery recovery = recovery_of(0);
  hear(0);
  for (int i = 0; i < 10; ++i) {
    now_ += 10s;
    EXPECT_THAT(look(recovery, 0, false).stand_ins, IsEmpty());
  }
}

TEST_F(Standing, AProcessThatOthersDoNotHearJoinsAnew) {
  Recovery recovery = recovery_of(2);
  for (const std::uint32_t region : {0U, 1U, 2U, 3U}) hear(region);
  does_not_hear(0, {RegionId{2}});
  EXPECT_FALSE(look(recovery, 2).meets_anew) << "discovery may be under way";
  now_ += 3s;
  EXPECT_TRUE(look(recovery, 2).meets_anew);
  EXPECT_FALSE(look(recovery, 2).meets_anew);
  does_not_hear(0, {});
  now_ += 3s;
  EXPECT_FALSE(look(recovery, 2).meets_anew);
}

TEST_F(Standing, TheFirstStateIsNotBegunAgainOnceALaterOneWasKept) {
  Recovery recovery = recovery_of(0);
  EXPECT_TRUE(recovery.may_begin_again(0));
  for (std::uint32_t region = 0; region < 4; ++region) {
    hear(region, NodeState::kRunning);
    nodes_[RegionId{region}].status.parts = {{RegionId{region}, 60}};
  }
  recovery.note_kept(nodes_, 0);
  EXPECT_FALSE(recovery.may_begin_again(0));
  EXPECT_EQ(recovery.kept(), 60);
  EXPECT_TRUE(recovery.may_begin_again(1)) << "another era has begun, and nothing of it is kept";
}

TEST_F(Standing, WhoWasLeftOutGivesWayOnceTheOthersCompute) {
  Recovery recovery = recovery_of(0);
  messages::RunCommand restore;
  restore.generation = 3;
  restore.at_step = 240;
  for (std::uint64_t region = 0; region < 4; ++region)
    restore.members.push_back({region == 0 ? 7 : 100 + region, {}, true});
  EXPECT_EQ(meaning_of(restore, RegionId{0}, 100, 1, 4), RestoreMeaning::kLeftOut);
  EXPECT_EQ(meaning_of(restore, RegionId{0}, 100, 1, 3), RestoreMeaning::kReplaced);
  EXPECT_EQ(meaning_of(restore, RegionId{0}, 100, 3, 3), RestoreMeaning::kNothing);
  EXPECT_EQ(meaning_of(restore, RegionId{1}, 101, 1, 2), RestoreMeaning::kGoBack);
  recovery.note_left_out(restore);
  hear(1);
  EXPECT_FALSE(look(recovery, 0).replaced_in);
  hear(1, NodeState::kRunning);
  nodes_[RegionId{1}].status.generation = 3;
  EXPECT_EQ(look(recovery, 0).replaced_in, 240);
}

TEST_F(Standing, ASpareIsCalledOnceForOneRegion) {
  Recovery recovery = recovery_of(0);
  messages::Status first, second;
  first.process = 71;
  second.process = 72;
  EXPECT_EQ(recovery.call_spare({first, second}, RegionId{2}, now_), 71U);
  EXPECT_EQ(recovery.call_spare({first, second}, RegionId{3}, now_), 72U);
  EXPECT_EQ(recovery.call_spare({first, second}, RegionId{1}, now_), std::nullopt) << "both have been called";
  EXPECT_EQ(recovery.call_spare({}, RegionId{1}, now_), std::nullopt);
}

TEST_F(Standing, NoOtherSpareIsCalledSoonForARegionThatHasGotOne) {
  Recovery recovery = recovery_of(0);
  for (const std::uint32_t region : {0U, 1U, 2U, 3U}) hear(region);
  lose(1);
  for (const std::uint32_t region : {0U, 2U, 3U}) does_not_hear(region, {RegionId{1}});
  EXPECT_THAT(look(recovery, 0).call_spares, ElementsAre(RegionId{1}));
  EXPECT_THAT(look(recovery, 0).call_spares, ElementsAre(RegionId{1})) << "there was no spare";
  messages::Status spare;
  spare.process = 71;
  recovery.call_spare({spare}, RegionId{1}, now_);
  EXPECT_THAT(look(recovery, 0).call_spares, IsEmpty());
}

TEST(WhatRecoveryWaitsFor, IsTheMostUrgentReason) {
  const std::vector<RegionId> none, two = {RegionId{2}}, both = {RegionId{1}, RegionId{3}};
  EXPECT_EQ(what_recovery_waits_for(true, "begin again?", two, both),
            "receives from too few of the other nodes, and waits for them");
  EXPECT_EQ(what_recovery_waits_for(false, "begin again?", two, both), "begin again?");
  EXPECT_EQ(what_recovery_waits_for(false, "", two, both), "waits for processes that take over regions [2]");
  EXPECT_EQ(what_recovery_waits_for(false, "", none, both),
            "does not receive from regions [1, 3], from which other nodes receive");
  EXPECT_EQ(what_recovery_waits_for(false, "", none, none), "waits until all other nodes have stopped computing");
  EXPECT_EQ(nobody_takes_over(both), "nobody takes over regions [1, 3], whose nodes have died");
}

}  // namespace
}  // namespace aurasim::process
