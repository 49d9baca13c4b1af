// Who may say what, without DDS: what is discovered, and whose nodes are known.
#include "dds/speakers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dds/rate_limit.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

class WhoMaySpeak : public ::testing::Test {
 protected:
  WhoMaySpeak() { speakers_.set_self(endpoint(kSelf).guidPrefix); }

  static Guid endpoint(unsigned char process, std::uint32_t number = 0x103U) {
    Guid guid;
    guid.guidPrefix.value[0] = process;
    guid.entityId = number;
    return guid;
  }
  void refuse(unsigned char process, std::uint64_t times) {
    for (std::uint64_t i = 0; i < times; ++i) speakers_.refuse(endpoint(process), "it lies");
  }

  static constexpr unsigned char kSelf = 1, kNode = 2, kStranger = 3;
  Speakers speakers_;
};

TEST_F(WhoMaySpeak, EverybodyMayBeforeTheNodeOfARegionIsKnown) {
  EXPECT_TRUE(speakers_.may_speak(endpoint(kStranger), RegionId{1}));
  EXPECT_TRUE(speakers_.is_node(endpoint(kStranger)));
  speakers_.set(RegionId{0}, endpoint(kSelf).guidPrefix);
  EXPECT_TRUE(speakers_.is_node(endpoint(kStranger))) << "no other node is known";
}

TEST_F(WhoMaySpeak, ThenOnlyThatNodeAndThisProcessMay) {
  speakers_.set(RegionId{1}, endpoint(kNode).guidPrefix);
  EXPECT_TRUE(speakers_.may_speak(endpoint(kNode, 0x203U), RegionId{1})) << "all its endpoints";
  EXPECT_TRUE(speakers_.may_speak(endpoint(kSelf), RegionId{1}));
  EXPECT_FALSE(speakers_.may_speak(endpoint(kStranger), RegionId{1}));
  EXPECT_TRUE(speakers_.may_speak(endpoint(kStranger), RegionId{2}));
  EXPECT_TRUE(speakers_.is_node(endpoint(kNode)));
  EXPECT_FALSE(speakers_.is_node(endpoint(kStranger)));
}

TEST_F(WhoMaySpeak, AWriterThatSpeaksByAHubIsAtHomeInItsRegion) {
  speakers_.add(endpoint(kNode), {"hub/region/1"});
  EXPECT_EQ(speakers_.home_of(endpoint(kNode)), RegionId{1});
  EXPECT_TRUE(speakers_.is_at_home(endpoint(kNode), RegionId{1}));
  EXPECT_FALSE(speakers_.is_at_home(endpoint(kNode), RegionId{2}));
}

TEST_F(WhoMaySpeak, AWriterThatMovesToThePartitionOfAnotherRegionIsAtHomeInNone) {
  speakers_.add(endpoint(kNode), {"region/1"});
  speakers_.add(endpoint(kNode), {"region/1"});
  EXPECT_TRUE(speakers_.is_at_home(endpoint(kNode), RegionId{1}));
  for (const char* partition : {"region/2", "region/1"}) {
    speakers_.add(endpoint(kNode), {partition});
    EXPECT_FALSE(speakers_.is_at_home(endpoint(kNode), RegionId{1})) << partition;
    EXPECT_FALSE(speakers_.is_at_home(endpoint(kNode), RegionId{2})) << partition;
  }
}

TEST_F(WhoMaySpeak, AHubIsKnownUntilItIsGone) {
  const ProcessPrefix first = endpoint(7).guidPrefix, second = endpoint(8).guidPrefix;
  EXPECT_FALSE(speakers_.has_hub());
  speakers_.add_hub(first);
  speakers_.add_hub(second);
  speakers_.remove_hub(first);
  EXPECT_FALSE(speakers_.is_hub(first));
  EXPECT_TRUE(speakers_.is_hub(second));
  EXPECT_TRUE(speakers_.has_hub());
}

TEST_F(WhoMaySpeak, TheLastWordsOfANodeThatWasReplacedAreNotTold) {
  speakers_.set(RegionId{1}, endpoint(kNode).guidPrefix);
  speakers_.set(RegionId{1}, endpoint(kStranger).guidPrefix);
  refuse(kNode, 3);
  EXPECT_THAT(speakers_.take_said(), IsEmpty());
  EXPECT_EQ(speakers_.refused(), 0U);
  refuse(kNode, Speakers::kPatience);
  EXPECT_TRUE(speakers_.shuns(endpoint(kNode).guidPrefix)) << "but that many are no last words";
}

TEST_F(WhoMaySpeak, AWriterIsAtHomeWhereAllItsPartitionsAre) {
  const auto is_at_home = [this](const std::vector<std::string>& partitions) {
    speakers_.add(endpoint(kNode), partitions);
    return speakers_.is_at_home(endpoint(kNode), RegionId{2});
  };
  EXPECT_TRUE(is_at_home({"region/2"}));
  EXPECT_TRUE(is_at_home({"region/2/to/3"}));
  EXPECT_TRUE(is_at_home({"region/2", "region/2/since/5"}));
  EXPECT_FALSE(is_at_home({"region/1"}));
  EXPECT_FALSE(is_at_home({"region/21"}));
  EXPECT_FALSE(is_at_home({"region/2", "region/1"}));
  EXPECT_FALSE(is_at_home({"region/*"}));
  EXPECT_FALSE(is_at_home({"region/2*"}));
  EXPECT_FALSE(is_at_home({"world"}));
  EXPECT_FALSE(is_at_home({}));
  EXPECT_TRUE(speakers_.is_at_home(endpoint(kNode, 0x203U), RegionId{2})) << "nothing is known of it";
}

TEST_F(WhoMaySpeak, WhatAWriterHasSaidBeforeItLeftIsStillItsRegions) {
  speakers_.add(endpoint(kNode), {"region/1"});
  speakers_.remove(endpoint(kNode));
  EXPECT_TRUE(speakers_.is_at_home(endpoint(kNode), RegionId{1}));
  EXPECT_FALSE(speakers_.is_at_home(endpoint(kNode), RegionId{2}));
}

TEST_F(WhoMaySpeak, WhoIsRefusedTooOftenIsNotListenedToAnyMore) {
  refuse(kStranger, Speakers::kPatience - 1);
  EXPECT_FALSE(speakers_.shuns(endpoint(kStranger).guidPrefix));
  EXPECT_THAT(speakers_.take_said(), ElementsAre(HasSubstr("process 03.00")));
  refuse(kStranger, 200);
  EXPECT_TRUE(speakers_.shuns(endpoint(kStranger).guidPrefix));
  EXPECT_THAT(speakers_.take_said(),
              ElementsAre(HasSubstr("not listened to any more: it has been refused 100 times, lastly: it lies")));
  EXPECT_EQ(speakers_.refused(), Speakers::kPatience + 199);
}

TEST_F(WhoMaySpeak, WhoSaysMoreThanItIsGivenIsNamedOnceForEachTopicAndNotShutOut) {
  for (int i = 0; i < 1000; ++i) {
    speakers_.ration(endpoint(kStranger), "command: 500 a second");
    speakers_.ration(endpoint(kStranger), "run_control: 500 a second");
  }
  EXPECT_FALSE(speakers_.shuns(endpoint(kStranger).guidPrefix));
  EXPECT_EQ(speakers_.refused(), 2000U);
  EXPECT_THAT(speakers_.take_said(),
              ElementsAre(HasSubstr("dropped: command: 500"), HasSubstr("dropped: run_control")));
}

TEST_F(WhoMaySpeak, ANodeIsNeverShunned) {
  speakers_.set(RegionId{1}, endpoint(kNode).guidPrefix);
  refuse(kNode, 1000);
  EXPECT_FALSE(speakers_.shuns(endpoint(kNode).guidPrefix)) << "it would be as good as dead";
  EXPECT_EQ(speakers_.refused(), 0U);
  EXPECT_THAT(speakers_.take_said(), IsEmpty());
}

TEST(ARateLimit, LetsSoManyThroughAtOnceAndThenSoManyASecond) {
  RateLimit<int> limit(10, 20);
  const auto start = std::chrono::steady_clock::time_point() + 1h;
  const auto passed = [&](int source, std::chrono::nanoseconds after) {
    int count = 0;
    while (count < 100 && limit.allows(source, start + after)) ++count;
    return count;
  };
  EXPECT_EQ(passed(1, 0s), 20);
  EXPECT_EQ(passed(2, 0s), 20) << "another source";
  EXPECT_EQ(passed(1, 500ms), 5);
  EXPECT_EQ(passed(1, 1h), 20);
}

TEST(ARateLimit, LetsMoreThroughThatWasEarnedOtherwise) {
  RateLimit<int> limit(10, 20);
  const RateLimit<int>::Time now{};
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(limit.allows(1, now));
  EXPECT_FALSE(limit.allows(1, now));
  limit.allow_more(2);
  EXPECT_TRUE(limit.allows(1, now));
  EXPECT_TRUE(limit.allows(1, now));
  EXPECT_FALSE(limit.allows(1, now));
  limit.allow_more(1000);
  int let_through = 0;
  while (limit.allows(1, now)) ++let_through;
  EXPECT_EQ(let_through, 20) << "as many as at once";
}

TEST(ARateLimit, RemembersOnlySoManySources) {
  RateLimit<int> limit(10, 20);
  const auto start = std::chrono::steady_clock::time_point() + 1h;
  for (int source = 0; source < 1024; ++source) EXPECT_TRUE(limit.allows(source, start));
  EXPECT_FALSE(limit.allows(5000, start));
  EXPECT_TRUE(limit.allows(5000, start + 1s)) << "the others are quiet";
}

}  // namespace
}  // namespace aurasim::dds
