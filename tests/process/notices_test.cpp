// Which message a node's status carries, and that nothing is said twice.
#include "process/notices.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using core::RegionId;

class NoticesTest : public ::testing::Test {
 protected:
  static constexpr std::chrono::steady_clock::time_point kBegin{100s};

  Notices notices_{RegionId{3}, {kBegin, 0}};
};

TEST_F(NoticesTest, AShortWaitIsNoMessage) {
  EXPECT_FALSE(notices_.waits_for_long(kBegin));
  EXPECT_FALSE(notices_.waits_for_long(kBegin + 1999ms));
  EXPECT_EQ(notices_.text(), "");
}

TEST_F(NoticesTest, ALongWaitNamesTheRegionsAndEndsWithTheNextState) {
  notices_.waits_for_long(kBegin);
  ASSERT_TRUE(notices_.waits_for_long(kBegin + 2s));
  const std::vector<MissingRegion> missing = {{RegionId{1}, {}, 0}, {RegionId{2}, "computes one step for 12 s", 4}};
  notices_.note_missing(7, missing, kBegin + 2s);
  EXPECT_EQ(notices_.text(),
            "waits for regions [1, 2 (computes one step for 12 s) (4 of its messages were refused)] before state 7, "
            "for 2 s");
  notices_.note_missing(7, missing, kBegin + 5s);
  EXPECT_NE(notices_.text().find("for 5 s"), std::string::npos);
  notices_.note_computed();
  EXPECT_EQ(notices_.text(), "");
  EXPECT_FALSE(notices_.waits_for_long(kBegin + 6s)) << "the next wait counts from its own beginning";
}

TEST_F(NoticesTest, AWaitForNobodyIsNoMessage) {
  notices_.waits_for_long(kBegin);
  notices_.note_missing(7, {}, kBegin + 5s);
  EXPECT_EQ(notices_.text(), "");
}

TEST_F(NoticesTest, AFaultIsMoreUrgentThanNewsAndAWaitThanAFault) {
  notices_.note_news("went back to state 3");
  EXPECT_EQ(notices_.text(), "went back to state 3");
  notices_.note_fault("nothing is recorded from here on");
  notices_.note_news("put back from state 9 to 5");
  EXPECT_EQ(notices_.text(), "nothing is recorded from here on");
  notices_.waits_for_long(kBegin);
  notices_.note_missing(7, std::vector<MissingRegion>{{RegionId{1}, {}, 0}}, kBegin + 3s);
  EXPECT_EQ(notices_.text(), "waits for regions [1] before state 7, for 3 s");
}

TEST_F(NoticesTest, OnlyBodiesThatBrokeDownAreFaults) {
  const std::vector<physics::Removal> removals = {{5, core::BodyId{8}, ""}, {6, core::BodyId{9}, "too fast"}};
  notices_.note_removals(removals);
  EXPECT_EQ(notices_.broken_bodies(), 1U);
  EXPECT_EQ(notices_.text(), "body 9 was taken out in state 6: too fast");
}

TEST_F(NoticesTest, ARefusalIsNotedOnceInEachWorld) {
  const std::vector<core::Refusal> refusals = {{RegionId{1}, 0, 12, core::MessageKind::kAura, "a body twice"}};
  notices_.note_refusals(refusals);
  EXPECT_NE(notices_.text().find("of region 1 for state 12: a body twice"), std::string::npos) << notices_.text();
  notices_.note_fault("another fault");
  notices_.note_refusals(refusals);
  EXPECT_EQ(notices_.text(), "another fault") << "it is known already";
  notices_.begin_refusals();
  notices_.note_refusals(refusals);
  EXPECT_NE(notices_.text(), "another fault") << "another world has refusals of its own";
}

TEST_F(NoticesTest, AWallClockThatIsSetIsNews) {
  notices_.note_clock({kBegin + 1s, 1'000'000'000}, 60);
  EXPECT_EQ(notices_.text(), "");
  notices_.note_clock({kBegin + 2s, 7'000'000'000}, 120);
  EXPECT_EQ(notices_.text(), "this host's wall clock was set 5.0 s forward at step 120: the pace is kept without it");
}

TEST_F(NoticesTest, AClusterOfMostBodiesIsSaidOnce) {
  notices_.note_cluster(999, 999, 5, {});
  notices_.note_cluster(1200, 2401, 6, {});
  EXPECT_EQ(notices_.text(), "") << "it is small, or less than half of the node's bodies";
  notices_.note_cluster(1200, 2400, 7, "exchange: coupled divides them");
  EXPECT_EQ(notices_.text().find("1200 of the 2400 bodies here are one cluster in state 7"), 0U) << notices_.text();
  EXPECT_NE(notices_.text().find("exchange: coupled divides them"), std::string::npos) << notices_.text();
  notices_.note_news("went back to state 3");
  notices_.note_cluster(2400, 2400, 8, {});
  EXPECT_EQ(notices_.text(), "went back to state 3");
}

TEST_F(NoticesTest, TheEndOfTheRecordsIsSaidOnce) {
  notices_.note_records({});
  EXPECT_EQ(notices_.text(), "");
  notices_.note_records(records::RecordsEnd{40, "no space left"});
  EXPECT_EQ(notices_.text(), "nothing is recorded after step 40: no space left");
  notices_.note_news("went back to state 3");
  notices_.note_records(records::RecordsEnd{40, "no space left"});
  EXPECT_EQ(notices_.text(), "went back to state 3");
}

}  // namespace
}  // namespace aurasim::process
