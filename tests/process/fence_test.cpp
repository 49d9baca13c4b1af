// When a node has to stand: it is not of the majority. Virtual time.
#include "process/fence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using core::RegionId;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class Fenced : public ::testing::Test {
 protected:
  Fence fence_of(std::uint32_t region, std::uint32_t regions, bool can_be_cut = true, bool never_waits = false) {
    return Fence({RegionId{region}, regions, can_be_cut, never_waits}, [this] { return peers_; });
  }
  bool open(Fence& fence) { return fence.open(dead_, now_); }
  void hear(std::uint32_t region) { peers_[RegionId{region}] = {false, false, now_}; }
  void lose(std::uint32_t region) { peers_[RegionId{region}].lost = true; }
  void leave(std::uint32_t region) { peers_[RegionId{region}].left = true; }
  void pass(std::chrono::milliseconds time) { now_ += time; }

  std::map<RegionId, node::PeerSign> peers_;
  std::vector<RegionId> dead_;
  Fence::Clock::time_point now_{1h};
};

TEST_F(Fenced, AWholeRunGoesOn) {
  Fence fence = fence_of(0, 3);
  hear(1);
  hear(2);
  EXPECT_TRUE(open(fence));
  EXPECT_FALSE(fence.closed());
}

TEST_F(Fenced, OnOneHostNobodyIsCutOff) {
  Fence fence = fence_of(0, 2, false);
  lose(1);
  dead_ = {RegionId{1}};
  EXPECT_TRUE(open(fence));
}

TEST_F(Fenced, WhoIsClosedStaysClosed) {
  Fence fence = fence_of(0, 3);
  EXPECT_TRUE(open(fence));
  fence.close("another process has taken over region 0");
  EXPECT_FALSE(open(fence));
  EXPECT_TRUE(fence.closed());
  EXPECT_THAT(fence.reason(), HasSubstr("region 0"));
}

TEST_F(Fenced, TheMinorityWaitsAndIsThenCutOff) {
  Fence fence = fence_of(2, 3);
  lose(0);
  hear(1);
  dead_ = {RegionId{0}};
  EXPECT_FALSE(open(fence)) << "has region 1 been heard since?";
  EXPECT_FALSE(fence.is_cut_off());
  lose(1);
  pass(60ms);
  EXPECT_FALSE(open(fence));
  EXPECT_TRUE(fence.is_cut_off());
  EXPECT_FALSE(fence.closed());
}

TEST_F(Fenced, TheMinorityStandsUntilTheOthersAreHeardAgain) {
  Fence fence = fence_of(2, 3);
  lose(0);
  lose(1);
  dead_ = {RegionId{0}, RegionId{1}};
  EXPECT_FALSE(open(fence));
  EXPECT_TRUE(fence.is_cut_off());
  pass(5min);
  EXPECT_FALSE(open(fence));
  EXPECT_FALSE(fence.closed());
  hear(0);
  hear(1);
  dead_ = {};
  pass(60ms);
  EXPECT_TRUE(open(fence));
  EXPECT_FALSE(fence.is_cut_off());
}

TEST_F(Fenced, WhatWasJudgedBeforeADeathDoesNotCountAfterIt) {
  Fence fence = fence_of(1, 3);
  hear(0);
  hear(2);
  EXPECT_TRUE(open(fence));
  lose(0);  // which no batch that is missing has told yet
  EXPECT_TRUE(open(fence));
  fence.watch_closely();
  EXPECT_FALSE(open(fence));
}

TEST_F(Fenced, TheMinorityNeverGivesItsWorldUp) {
  Fence fence = fence_of(2, 3);
  lose(0);
  lose(1);
  dead_ = {RegionId{0}, RegionId{1}};
  EXPECT_FALSE(open(fence));
  pass(24h);
  EXPECT_FALSE(open(fence));
  EXPECT_FALSE(fence.closed());
}

// The stream of a neighbour begins anew only after the recovery, so its end says nothing about the neighbour by then.
TEST_F(Fenced, WhoStandsBelievesTheStatusesAndNotTheStreamsThatHaveEnded) {
  Fence fence = fence_of(2, 3);
  lose(0);
  lose(1);
  dead_ = {RegionId{0}, RegionId{1}};
  EXPECT_FALSE(open(fence));
  fence.watch_closely();
  EXPECT_FALSE(open(fence));
  pass(15s);
  hear(0);
  hear(1);
  EXPECT_TRUE(open(fence)) << "dead_ still has both";
  EXPECT_FALSE(fence.is_cut_off());
}

TEST_F(Fenced, TheMajorityGoesOnOnceItHasHeardOfTheRest) {
  Fence fence = fence_of(2, 3);
  lose(0);
  dead_ = {RegionId{0}};
  EXPECT_FALSE(open(fence));
  pass(60ms);
  hear(1);
  EXPECT_TRUE(open(fence));
}

TEST_F(Fenced, WhoNeverWaitsGoesOnWhileItIsNotCutOff) {
  Fence fence = fence_of(2, 3, true, true);
  lose(0);
  dead_ = {RegionId{0}};
  EXPECT_TRUE(open(fence));
}

TEST_F(Fenced, WhoHasLeftIsNotMissed) {
  Fence fence = fence_of(1, 2);
  leave(0);
  lose(0);
  EXPECT_TRUE(open(fence));
}

TEST_F(Fenced, ANodeThatIsAloneIsNeverFenced) {
  Fence fence = fence_of(0, 1);
  EXPECT_TRUE(open(fence));
}

}  // namespace
}  // namespace aurasim::process
