#include "launch/closing_line.h"

#include <gtest/gtest.h>

namespace aurasim::launch {
namespace {

class ClosingLine : public ::testing::Test {
 protected:
  void end(std::uint32_t region, std::uint64_t bodies, messages::NodeState state = messages::NodeState::kFinished) {
    messages::SeenStatus& seen = statuses_[core::RegionId{region}];
    seen.status.state = state;
    seen.status.step = 600;
    seen.status.bodies = bodies;
    seen.status.hand_offs_out = 10 + region;
    seen.status.late_collisions = region;
  }
  std::string line(bool has_begun = true) const { return closing_line(statuses_, 3, has_begun, 1.0 / 60); }

  std::map<core::RegionId, messages::SeenStatus> statuses_;
};

TEST_F(ClosingLine, SumsWhatTheNodesHaveSaidLast) {
  end(0, 5), end(1, 0), end(2, 7);
  EXPECT_EQ(line(), "ended with state 600, 10.00 s: 12 bodies, 33 hand-offs, 3 late and 0 missed collisions\n");
}

TEST_F(ClosingLine, NamesThePromisesThatWereBroken) {
  end(0, 5), end(1, 0), end(2, 7);
  statuses_[core::RegionId{0}].status.violations.frame = 3;
  statuses_[core::RegionId{1}].status.violations = {.speed = 1, .frame = 4};
  EXPECT_EQ(line(),
            "ended with state 600, 10.00 s: 12 bodies, 33 hand-offs, 3 late and 0 missed collisions; broken "
            "promises: frame 7, speed 1\n");
}

TEST_F(ClosingLine, NamesThoseOfWhomNothingIsKnown) {
  end(0, 5), end(1, 9, messages::NodeState::kRunning);
  EXPECT_EQ(line(),
            "ended with state 600, 10.00 s: 5 bodies, 10 hand-offs, 0 late and 0 missed collisions; without regions "
            "[1, 2], whose bodies are not known\n");
}

TEST_F(ClosingLine, IsThereForARunThatBrokeOffOrHasNotBegun) {
  EXPECT_EQ(line(),
            "the run has broken off: no node has published that it came to its end. --report DIR keeps the records of "
            "each node\n");
  EXPECT_EQ(line(false), "the run has not begun\n");
}

}  // namespace
}  // namespace aurasim::launch
