// The table fits into its terminal.
#include "launch/live_table.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::launch {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StrEq;

class LiveTable : public ::testing::Test {
 protected:
  void have_regions(std::uint32_t count) {
    for (std::uint32_t r = 0; r < count; ++r) {
      messages::SeenStatus& seen = statuses_[core::RegionId{r}];
      seen.status.region = core::RegionId{r};
      seen.status.state = messages::NodeState::kFinished;
      seen.status.step = 123'456;
      seen.status.bodies = 10'000;
      seen.status.awake = 10'000;
      seen.status.foreign_auras = 10'000;
      seen.status.hand_offs_out = 1'234'567;
      seen.status.hand_offs_in = 1'234'567;
      seen.status.violations.speed = 98'765;
      seen.status.frame = {123.45, 1234.56, 1234.56};
      seen.status.real_time_factor = 0.5;
    }
  }
  std::vector<std::string> lines(TerminalSize size) const {
    std::istringstream text(live_table(statuses_, size));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }

  std::map<core::RegionId, messages::SeenStatus> statuses_;
};

TEST_F(LiveTable, NoLineIsAsWideAsTheTerminal) {
  have_regions(9);
  for (std::size_t columns = 20; columns <= 132; ++columns) {
    const std::vector<std::string> table = lines({columns, 50});
    EXPECT_EQ(table.size(), 11U);
    for (const std::string& line : table) EXPECT_LT(line.size(), columns) << line;
  }
}

TEST_F(LiveTable, NamesWhoListensToWhomSinceWhenAndWhy) {
  have_regions(2);
  EXPECT_EQ(listening_lines(statuses_), "");
  statuses_[core::RegionId{1}].status.listens_to = {{core::RegionId{0}, 0, {}},
                                                    {core::RegionId{7}, 120, core::RegionId{3}}};
  EXPECT_EQ(listening_lines(statuses_), "region 1 listens to 0, 7 (since state 120, by 3)\n");
}

TEST_F(LiveTable, SaysWhoComputesOneStepForLong) {
  have_regions(2);
  const std::chrono::steady_clock::time_point now(std::chrono::seconds(100));
  statuses_[core::RegionId{1}].status.state = messages::NodeState::kRunning;
  statuses_[core::RegionId{1}].seen = now - std::chrono::seconds(12);
  EXPECT_THAT(live_table(statuses_, {}, now), HasSubstr("region 1 computes one step for 12 s\n"));
  EXPECT_THAT(live_table(statuses_, {}, now), Not(HasSubstr("region 0 computes")));
}

TEST_F(LiveTable, SaysWhichExchangeRunsAndWhatOneTakes) {
  have_regions(2);
  EXPECT_THAT(live_table(statuses_, {}), Not(HasSubstr("exchange"))) << "it is not chosen yet";
  for (auto& [region, seen] : statuses_) seen.status.exchange = messages::ExchangeInUse::kAura;
  EXPECT_THAT(lines({}).back(), StrEq("exchange: aura"));
  for (auto& [region, seen] : statuses_) seen.status.exchange = messages::ExchangeInUse::kCoupled;
  statuses_[core::RegionId{0}].status.round_trip_ms = 0.12;
  statuses_[core::RegionId{0}].status.exchange_times = {0.05, 0.2, 1};
  statuses_[core::RegionId{1}].status.exchange_times = {0.06, 0.3, 1};
  EXPECT_THAT(lines({}).back(), StrEq("exchange: coupled, chosen for round trips of 0.12 ms, one takes 0.06 ms (99% at "
                                      "most 0.3 ms, region 1)"));
}

TEST_F(LiveTable, NamesWhoseMessagesAreRefused) {
  have_regions(1);
  statuses_[core::RegionId{0}].status.refused = {{core::RegionId{2}, 3}, {messages::kNoRegion, 170}};
  EXPECT_THAT(lines({}).back(), HasSubstr("region 0 has refused messages: 3 of region 2, 170 of no node"));
}

TEST_F(LiveTable, EightyColumnsKeepWhatMattersMost) {
  have_regions(9);
  const std::string head = lines({80, 24}).front();
  for (const char* name : {"region", "state", "step", "bodies", "sent", "received", "frame ms", "broken", "rtf"}) {
    EXPECT_THAT(head, HasSubstr(name));
  }
  EXPECT_THAT(head, Not(HasSubstr("p99")));
}

TEST_F(LiveTable, AWideTerminalAndAFileHaveAllColumns) {
  have_regions(4);
  EXPECT_THAT(lines({}).front(), HasSubstr("p99 ms"));
  EXPECT_THAT(lines({120, 40}).front(), HasSubstr("awake"));
}

TEST_F(LiveTable, MoreRegionsThanRowsAreCounted) {
  have_regions(40);
  const std::vector<std::string> table = lines({80, 24});
  EXPECT_LT(table.size(), 24U) << "the screen would scroll";
  EXPECT_THAT(table[table.size() - 2], HasSubstr("... 24 more"));
  EXPECT_THAT(table.back(), HasSubstr("400000")) << "the sums are of all";
}

TEST_F(LiveTable, NoNodeYetIsAHeadAndSums) { EXPECT_EQ(lines({80, 24}).size(), 2U); }

}  // namespace
}  // namespace aurasim::launch
