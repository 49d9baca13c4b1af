// What is said of a node that computes one step for long, in virtual time.
#include "process/long_step.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class LongStep : public ::testing::Test {
 protected:
  LongStep() {
    seen_.status.region = core::RegionId{3};
    seen_.status.state = messages::NodeState::kRunning;
    seen_.status.step = 17;
    seen_.seen = begin_;
  }
  /// What is logged while the launcher looks ten times a second.
  std::vector<std::string> told(std::chrono::seconds until) {
    std::vector<std::string> lines;
    for (auto now = begin_; now <= begin_ + until; now += 100ms) {
      if (const auto line = steps_.news(seen_, now)) lines.push_back(*line);
    }
    return lines;
  }

  const LongSteps::Clock::time_point begin_{100s};
  messages::SeenStatus seen_;
  LongSteps steps_;
};

TEST_F(LongStep, IsSaidOfWhoLivesAndPublishesNothing) {
  EXPECT_EQ(long_step(seen_, begin_ + 1s), std::nullopt);
  EXPECT_EQ(long_step(seen_, begin_ + 12s), "computes one step for 12 s");
}

TEST_F(LongStep, IsNotSaidOfTheDeadNorOfThoseWhoStand) {
  seen_.lost = true;
  EXPECT_EQ(long_step(seen_, begin_ + 12s), std::nullopt);
  seen_.lost = false;
  seen_.status.state = messages::NodeState::kPaused;
  EXPECT_EQ(long_step(seen_, begin_ + 12s), std::nullopt);
}

TEST_F(LongStep, IsLoggedAfterTenSecondsAndEachTimeThatItHasTakenTwiceAsLong) {
  const std::vector<std::string> lines = told(100s);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_THAT(lines[0], HasSubstr("region 3"));
  EXPECT_THAT(lines[0], HasSubstr("computes one step for 10 s, after state 17"));
  EXPECT_THAT(lines[1], HasSubstr("for 20 s"));
  EXPECT_THAT(lines[3], HasSubstr("for 80 s"));
}

TEST_F(LongStep, TheNextOneIsToldAnew) {
  EXPECT_EQ(told(15s).size(), 1U);
  seen_.seen = begin_ + 15s;
  EXPECT_EQ(steps_.news(seen_, begin_ + 15s), std::nullopt);
  EXPECT_NE(steps_.news(seen_, begin_ + 25s), std::nullopt);
}

TEST_F(LongStep, OfAnyOtherNodeIsNoReasonToGiveUpWaiting) {
  const std::map<core::RegionId, messages::SeenStatus> nodes = {{core::RegionId{3}, seen_}};
  EXPECT_FALSE(computes_for_long(nodes, core::RegionId{0}, begin_ + 1s));
  EXPECT_TRUE(computes_for_long(nodes, core::RegionId{0}, begin_ + 30s));
  EXPECT_FALSE(computes_for_long(nodes, core::RegionId{3}, begin_ + 30s)) << "this node itself";
  EXPECT_FALSE(computes_for_long({}, core::RegionId{0}, begin_ + 30s));
}

}  // namespace
}  // namespace aurasim::process
