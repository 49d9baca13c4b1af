// Who may go on when regions fall silent. Time is made up.
#include "node/quorum.h"

#include <optional>

#include <gtest/gtest.h>

namespace aurasim::node {
namespace {

using namespace std::chrono_literals;
using core::RegionId;
using Time = std::chrono::steady_clock::time_point;

class QuorumTest : public ::testing::Test {
 protected:
  /// Node `self` of a run of `regions`, all of which it has just heard.
  void make(std::uint32_t self, std::uint32_t regions) {
    signs_.clear();
    quorum_.emplace(RegionId{self}, regions);
    for (std::uint32_t r = 0; r < regions; ++r) {
      if (r != self) hear({r});
    }
    ASSERT_EQ(judge(), Standing::kGoOn);
  }

  void hear(std::initializer_list<std::uint32_t> regions) {
    now_ += 1ms;
    for (const std::uint32_t r : regions) signs_[RegionId{r}].heard = now_;
  }
  void lose(std::uint32_t region) { signs_[RegionId{region}].lost = true; }
  void leave(std::uint32_t region) { signs_[RegionId{region}].left = true; }

  Standing judge() {
    now_ += 1ms;
    return quorum_->judge(signs_, now_);
  }

  /// The regions whose bits are set in `side` lose the others, one after the other.
  Standing after_a_cut(std::uint32_t side, std::uint32_t self, std::uint32_t regions) {
    const auto with_self = [&](std::uint32_t r) { return ((side >> r) & 1U) == ((side >> self) & 1U); };
    Standing standing = Standing::kWait;
    for (std::uint32_t r = 0; r < regions; ++r) {
      if (with_self(r)) continue;
      lose(r);
      judge();
      for (std::uint32_t s = 0; s < regions; ++s) {
        if (s != self && with_self(s)) hear({s});
      }
      standing = judge();
    }
    return standing;
  }

  std::optional<Quorum> quorum_;
  std::map<RegionId, PeerSign> signs_;
  Time now_ = Time(1h);
};

TEST_F(QuorumTest, TheMajorityGoesOnOnceItHasBeenHeardAgain) {
  make(0, 4);
  lose(3);
  EXPECT_EQ(judge(), Standing::kWait);
  hear({1});
  EXPECT_EQ(judge(), Standing::kGoOn);
  EXPECT_TRUE(quorum_->members().contains(RegionId{3})) << "its region gets a node again";
}

TEST_F(QuorumTest, WhoeverHasLostTheMajorityIsCutOff) {
  make(0, 4);
  lose(1);
  EXPECT_EQ(judge(), Standing::kWait);
  lose(2);
  EXPECT_EQ(judge(), Standing::kWait);
  lose(3);
  EXPECT_EQ(judge(), Standing::kCutOff);
}

TEST_F(QuorumTest, WhatWasHeardBeforeALossSaysNothing) {
  make(3, 4);
  hear({0, 1, 2});
  lose(2);
  EXPECT_EQ(judge(), Standing::kWait);
  hear({0});
  lose(1);
  EXPECT_EQ(judge(), Standing::kWait);
  lose(0);
  EXPECT_EQ(judge(), Standing::kCutOff);
}

TEST_F(QuorumTest, OfTwoHalvesTheOneWithTheLowestRegionGoesOn) {
  make(1, 4);
  lose(2);
  lose(3);
  judge();
  hear({0});
  EXPECT_EQ(judge(), Standing::kGoOn);

  make(2, 4);
  lose(0);
  lose(1);
  judge();
  hear({3});
  EXPECT_EQ(judge(), Standing::kCutOff);
}

TEST_F(QuorumTest, OfTwoRegionsTheLowerGoesOn) {
  make(0, 2);
  lose(1);
  EXPECT_EQ(judge(), Standing::kGoOn);
  make(1, 2);
  lose(0);
  EXPECT_EQ(judge(), Standing::kCutOff);
}

// Regions 3, 2 and 1 lose touch one after the other. If losses were forgotten, region 0 would go on alone, while the
// other three, who hear each other again, are the majority.
TEST_F(QuorumTest, TheMajorityIsOneOfAllRegions) {
  make(0, 4);
  lose(3);
  judge();
  hear({1, 2});
  EXPECT_EQ(judge(), Standing::kGoOn);
  lose(2);
  judge();
  hear({1});
  EXPECT_EQ(judge(), Standing::kGoOn) << "half, with the lowest";
  lose(1);
  EXPECT_EQ(judge(), Standing::kCutOff);
  EXPECT_EQ(quorum_->members().size(), 4U);
}

TEST_F(QuorumTest, WhoeverHasSaidThatItEndsIsNotMissed) {
  make(3, 4);
  for (const std::uint32_t region : {0U, 1U, 2U}) leave(region);
  for (const std::uint32_t region : {0U, 1U, 2U}) lose(region);
  EXPECT_EQ(judge(), Standing::kGoOn);
}

TEST_F(QuorumTest, ARegionThatIsHeardAgainWasNotLost) {
  make(3, 4);
  lose(0);
  EXPECT_EQ(judge(), Standing::kWait);
  signs_[RegionId{0}].lost = false;
  EXPECT_EQ(judge(), Standing::kGoOn);
  EXPECT_EQ(quorum_->members().size(), 4U);
}

// However a run of five falls into two, exactly one part goes on, and all of it.
TEST_F(QuorumTest, ExactlyOneSideOfACutGoesOn) {
  constexpr std::uint32_t kRegions = 5;
  for (std::uint32_t side = 1; side < (1U << kRegions) - 1; ++side) {
    std::uint32_t going_on = 0;
    for (std::uint32_t self = 0; self < kRegions; ++self) {
      make(self, kRegions);
      if (after_a_cut(side, self, kRegions) == Standing::kGoOn) going_on |= 1U << self;
    }
    const std::uint32_t other_side = ((1U << kRegions) - 1) & ~side;
    EXPECT_TRUE(going_on == side || going_on == other_side) << "side " << side << ", going on " << going_on;
  }
}

}  // namespace
}  // namespace aurasim::node
