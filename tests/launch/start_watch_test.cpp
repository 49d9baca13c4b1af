// When does a launcher give up a run that does not begin? In virtual time.
#include "launch/start_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::launch {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class Start : public testing::Test {
 protected:
  void says(std::uint32_t region, messages::NodeState state) {
    messages::SeenStatus& seen = statuses_[core::RegionId{region}];
    seen.status.state = state;
    seen.seen = now_;
  }
  std::string after(std::chrono::seconds wait) {
    now_ += wait;
    return watch_.problem(statuses_, now_).value_or("");
  }

  StartWatch::Clock::time_point now_{};
  StartWatch watch_{3, 20s, now_};  // and 10 s more
  std::map<core::RegionId, messages::SeenStatus> statuses_;
};

TEST_F(Start, WaitsForWhoIsOnTheWay) {
  EXPECT_EQ(after(29s), "");
  says(0, messages::NodeState::kStarting);
  EXPECT_EQ(after(29s), "");
  says(0, messages::NodeState::kWaiting);
  EXPECT_EQ(after(29s), "") << "each step further gives the rest as long again";
  for (const std::uint32_t all : {0U, 1U, 2U}) says(all, messages::NodeState::kWaiting);
  EXPECT_EQ(after(29s), "");
  for (const std::uint32_t all : {0U, 1U, 2U}) says(all, messages::NodeState::kWaiting);
  EXPECT_EQ(after(29s), "");
  for (const std::uint32_t all : {0U, 1U, 2U}) says(all, messages::NodeState::kWaiting);
  EXPECT_EQ(after(29s), "") << "nobody is silent, though nobody comes further: the nodes' own time-outs see to that";
}

TEST_F(Start, NamesWhoNeverSpoke) {
  says(1, messages::NodeState::kWaiting);
  EXPECT_EQ(after(20s), "");
  says(1, messages::NodeState::kWaiting);
  EXPECT_EQ(after(11s), "");
  says(1, messages::NodeState::kWaiting);
  EXPECT_THAT(after(20s), HasSubstr("the nodes of regions [0, 2] have published nothing for 30 s"));
}

TEST_F(Start, NamesWhoHasFallenSilent) {
  for (const std::uint32_t all : {0U, 1U, 2U}) says(all, messages::NodeState::kWaiting);
  EXPECT_EQ(after(0s), "");
  EXPECT_EQ(after(20s), "");
  for (const std::uint32_t some : {0U, 1U}) says(some, messages::NodeState::kWaiting);
  EXPECT_EQ(after(10s), "");
  for (const std::uint32_t some : {0U, 1U}) says(some, messages::NodeState::kWaiting);
  EXPECT_THAT(after(1s), HasSubstr("the nodes of regions [2] have published nothing"));
}

}  // namespace
}  // namespace aurasim::launch
