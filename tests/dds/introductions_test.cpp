// Whom the hub introduces to whom and when, and what it keeps for those who come later; without DDS, in virtual time.
#include "dds/introductions.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "datagram_samples.h"
#include "dds/endpoints.h"
#include "dds/kept_samples.h"
#include "dds/rising_time.h"
#include "dds/seen_numbers.h"
#include "rtps/readdressed.h"

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;
using Strings = std::vector<std::string>;

TEST(Partitions, AreSharedByEqualNamesAndByPatternsFromEitherSide) {
  EXPECT_TRUE(share_a_partition({"region/3"}, {"region/2", "region/3"}));
  EXPECT_TRUE(share_a_partition({"region/*/to/5"}, {"region/3/to/5"}));
  EXPECT_TRUE(share_a_partition({"region/3/to/5"}, {"region/*/to/5"}));
  EXPECT_FALSE(share_a_partition({"region/3/to/5"}, {"region/*/to/4"}));
  EXPECT_FALSE(share_a_partition({"hub/world"}, {"world"}));
  EXPECT_FALSE(share_a_partition({"region/3"}, {"region/31"}));
}

TEST(Partitions, OfNoNameAreSharedWithThoseOfAnyName) {
  EXPECT_TRUE(share_a_partition({}, {}));
  EXPECT_TRUE(share_a_partition({}, {""}));
  EXPECT_TRUE(share_a_partition({}, {"*"}));
  EXPECT_FALSE(share_a_partition({}, {"world"}));
}

rtps::GuidPrefix prefix(std::uint8_t number) {
  rtps::GuidPrefix prefix{};
  prefix[0] = number;
  return prefix;
}

/// A datagram with the announcement of a participant, sent to one other only.
std::vector<std::uint8_t> announcement(std::uint8_t from) {
  using namespace testing;
  rtps::GuidPrefix sender = prefix(from);
  auto bytes = datagram({submessage(0x0e, 0, Octets().raw(Bytes(12, 99))),
                         data(rtps::kParticipantWriter, 1, participant(sender).bytes())});
  std::ranges::copy(sender, bytes.begin() + 8);
  return bytes;
}

class Introducing : public ::testing::Test {
 protected:
  void join(std::uint8_t number) {
    introductions_.hear(announcement(number));
    introductions_.add(prefix(number), {0x7f000001, static_cast<std::uint16_t>(7400 + number)});
  }
  void add_writer(std::uint8_t number, Strings partitions, const std::string& topic = "aura") {
    introductions_.add({{prefix(number), 0x102}, true, topic, std::move(partitions)});
  }
  void add_reader(std::uint8_t number, Strings partitions, const std::string& topic = "aura") {
    introductions_.add({{prefix(number), 0x107}, false, topic, std::move(partitions)});
  }
  /// Who is announced to whom.
  std::vector<std::pair<int, int>> introduced(Introductions::Time now) {
    std::vector<std::pair<int, int>> pairs;
    for (const Introduction& one : introductions_.take_due(now)) {
      pairs.emplace_back(rtps::sender_of(one.announcement)[0], one.to.port - 7400);
    }
    std::ranges::sort(pairs);
    return pairs;
  }
  using Pairs = std::vector<std::pair<int, int>>;

  Introductions introductions_;
};

TEST_F(Introducing, TheTwoWhoseEndpointsMatchAreAnnouncedToEachOther) {
  for (const std::uint8_t number : {1, 2, 3}) join(number);
  add_writer(1, {"region/1"});
  add_writer(3, {"region/3"});
  add_reader(2, {"region/1", "region/5"});
  EXPECT_EQ(introduced(1s), (Pairs{{1, 2}, {2, 1}}));
}

TEST_F(Introducing, OtherTopicsDoNotMatch) {
  join(1);
  join(2);
  add_writer(1, {"world"}, "run_control");
  add_reader(2, {"world"}, "command");
  EXPECT_EQ(introduced(1s), Pairs{});
}

TEST_F(Introducing, ThoseWhoSpeakByTheHubAloneAreNotIntroduced) {
  join(1);
  join(2);
  add_writer(1, {"hub/world"}, "run_control");
  add_reader(2, {"world"}, "run_control");
  add_writer(2, {"hub/region/2"}, "node_status");
  add_reader(1, {"region/*"}, "node_status");
  EXPECT_EQ(introduced(1s), Pairs{});
}

/// The hubs of two sites know each other, and each announces its own nodes to the other.
TEST_F(Introducing, HubsOfOtherSitesMeetTheNodesOfThisOne) {
  for (const std::uint8_t number : {1, 2, 9}) join(number);
  add_writer(1, {"hub/region/1"}, "node_status");
  add_writer(9, {"region/*", "region/hub"}, "node_status");
  add_reader(9, {"hub/*"}, "node_status");
  EXPECT_EQ(introduced(1s), (Pairs{{1, 9}, {9, 1}})) << "the other hub (9) reads what its nodes say";
  add_reader(2, {"region/*"}, "node_status");
  EXPECT_EQ(introduced(1s + 10ms), (Pairs{{2, 9}, {9, 2}})) << "and speaks to all";
}

TEST_F(Introducing, EndpointsThatComeWhileTheRunGoesOnMatchToo) {
  join(1);
  join(2);
  add_writer(1, {"region/1"});
  EXPECT_EQ(introduced(1s), Pairs{});
  add_reader(2, {"region/1"});
  EXPECT_EQ(introduced(100s).size(), 2U);
}

TEST_F(Introducing, IsRepeatedAtFirstBecauseADatagramMayBeLost) {
  join(1);
  join(2);
  add_writer(1, {"region/1"});
  add_reader(2, {"region/1"});
  EXPECT_EQ(introduced(10s).size(), 2U);
  EXPECT_EQ(introduced(10s + 99ms).size(), 0U);
  EXPECT_EQ(introduced(10s + 100ms).size(), 2U);
  EXPECT_EQ(introduced(10s + 500ms).size(), 2U);
  EXPECT_EQ(introduced(12s).size(), 2U);
  EXPECT_EQ(introduced(14s).size(), 0U);
}

TEST_F(Introducing, IsRepeatedLaterOnlyOfThoseWhoAnnounceThemselvesStill) {
  join(1);
  join(2);
  add_writer(1, {"region/1"});
  add_reader(2, {"region/1"});
  for (const Introductions::Time time : {10s, 11s, 12s, 13s}) introduced(time);
  introductions_.hear(announcement(2));
  EXPECT_EQ(introduced(20s), (Pairs{{2, 1}})) << "the other one may have died";
  EXPECT_EQ(introduced(30s), Pairs{});
}

TEST_F(Introducing, WaitsUntilBothAreKnown) {
  add_writer(1, {"region/1"});
  add_reader(2, {"region/1"});
  join(1);
  EXPECT_EQ(introduced(1s), Pairs{});
  introductions_.add(prefix(2), {0x7f000001, 7402});
  EXPECT_EQ(introduced(2s), Pairs{}) << "its announcement is not known yet";
  introductions_.hear(announcement(2));
  EXPECT_EQ(introduced(3s).size(), 2U);
}

TEST_F(Introducing, EndsWhenOneOfThemHasGone) {
  join(1);
  join(2);
  add_writer(1, {"region/1"});
  add_reader(2, {"region/1"});
  introduced(1s);
  EXPECT_EQ(introductions_.pairs(), 1U);
  introductions_.remove(prefix(1));
  EXPECT_EQ(introductions_.pairs(), 0U);
  EXPECT_EQ(introduced(10s), Pairs{});
  join(1);
  EXPECT_EQ(introduced(20s), Pairs{}) << "its endpoints are gone, too";
}

TEST(AnAnnouncementPassedOn, IsForEverybody) {
  const auto passed = rtps::for_everybody(announcement(7));
  ASSERT_TRUE(passed);
  const auto original = announcement(7);
  ASSERT_EQ(passed->size(), original.size());
  EXPECT_EQ(rtps::sender_of(*passed), prefix(7));
  EXPECT_EQ(original[24], 99);
  EXPECT_EQ((*passed)[24], 0) << "no receiver";
}

TEST(AnAnnouncementPassedOn, HasToBeSound) {
  auto cut = announcement(7);
  cut.resize(30);
  EXPECT_FALSE(rtps::for_everybody(cut));
  EXPECT_FALSE(rtps::for_everybody({}));
}

Guid writer(unsigned char process) {
  Guid guid;
  guid.guidPrefix.value[0] = process;
  return guid;
}

PassedSample sample(unsigned char process, std::int64_t number, std::uint8_t key = 0) {
  PassedSample sample;
  sample.writer = writer(process);
  sample.number = number;
  sample.key[0] = key;
  return sample;
}

std::vector<std::int64_t> numbers(const KeptSamples& kept) {
  std::vector<std::int64_t> numbers;
  for (const PassedSample& one : kept.all()) numbers.push_back(one.number);
  return numbers;
}

TEST(KeptSamples, AreTheLastOfEachWriterAndKey) {
  KeptSamples kept(2);
  for (int number = 1; number <= 3; ++number) kept.keep(sample(1, number));
  kept.keep(sample(2, 11));
  kept.keep(sample(1, 4, 9));
  EXPECT_EQ(numbers(kept), (std::vector<std::int64_t>{2, 3, 11, 4}));
}

TEST(KeptSamples, OfAWriterThatIsGoneReachNobody) {
  KeptSamples kept(2);
  kept.keep(sample(1, 1));
  kept.keep(sample(2, 2));
  EXPECT_FALSE(kept.keep_only_of({writer(1), writer(2)}));
  EXPECT_TRUE(kept.keep_only_of({writer(2)}));
  EXPECT_EQ(numbers(kept), (std::vector<std::int64_t>{2}));
}

TEST(SeenNumbers, OfEachWriterCountOnce) {
  SeenNumbers seen;
  EXPECT_TRUE(seen.is_news(writer(1), 5));
  EXPECT_TRUE(seen.is_news(writer(2), 5));
  EXPECT_FALSE(seen.is_news(writer(1), 5)) << "another hub has passed it on, too";
  EXPECT_FALSE(seen.is_news(writer(1), 3));
  EXPECT_TRUE(seen.is_news(writer(1), 6));
}

TEST(RisingTime, IsTheWallClockWhileThatGoesForward) {
  RisingTime sent;
  EXPECT_EQ(sent.next(5'000'000), 5'000'000);
  EXPECT_EQ(sent.next(7'000'000), 7'000'000);
}

TEST(RisingTime, RisesWhereTheWallClockStandsOrIsSetBack) {
  RisingTime sent;
  std::int64_t last = sent.next(3'600'000'000'000);
  for (const std::int64_t wall_ns : {3'600'000'000'000, 3'599'999'999'999, 0L, -1L, 1'000'000L}) {
    const std::int64_t next = sent.next(wall_ns);
    EXPECT_GT(next, last);
    EXPECT_LT(next, last + 1'000'000) << "it has to meet the clock again";
    last = next;
  }
  EXPECT_EQ(sent.next(3'700'000'000'000), 3'700'000'000'000);
}

TEST(Origin, KnowsTheClockOfTheSenderByWhatItSays) {
  Origin origin;
  origin.received_ns = 10'000;
  origin.clock_ahead = 7ns;  // of the hub
  for (const std::int64_t said_ns : {std::int64_t{0}, std::int64_t{-1}, INT64_MIN}) {
    origin.heed(said_ns);
    EXPECT_EQ(origin.clock_ahead, 7ns) << "it says nothing";
  }
  origin.heed(10'250);
  EXPECT_EQ(origin.clock_ahead, 250ns);
}

}  // namespace
}  // namespace aurasim::dds
