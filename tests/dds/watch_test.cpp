// When a remote writer counts as lost, without DDS: the listener is told what Fast DDS would tell it.
#include "dds/watch.h"

#include <map>
#include <optional>

#include <gtest/gtest.h>

namespace aurasim::dds {
namespace {

using eprosima::fastdds::dds::LivelinessChangedStatus;
using eprosima::fastdds::dds::SubscriptionMatchedStatus;
using namespace std::chrono_literals;

class Watched : public ::testing::Test {
 protected:
  static Guid writer(unsigned char number) {
    Guid guid;
    guid.guidPrefix.value[0] = number;
    guid.entityId = 0x103U;
    return guid;
  }
  void match(const Guid& guid, int change = 1) {
    SubscriptionMatchedStatus status;
    status.current_count_change = change;
    status.last_publication_handle = guid;
    watch_.on_subscription_matched(nullptr, status);
  }
  void live(const Guid& guid, int change) {
    LivelinessChangedStatus status;
    status.alive_count_change = change;
    status.last_publication_handle = guid;
    watch_.on_liveliness_changed(nullptr, status);
  }

  Wakeup wakeup_;
  ReaderWatch watch_{wakeup_};
};

TEST_F(Watched, AWriterIsNeitherAliveNorLostBeforeItsFirstProofOfLife) {
  EXPECT_EQ(watch_.latest().order, 0U);
  EXPECT_FALSE(watch_.any_matched());
  match(writer(1));
  EXPECT_EQ(watch_.latest().order, 1U);
  EXPECT_FALSE(watch_.latest().alive);
  EXPECT_FALSE(watch_.latest().lost);
  EXPECT_TRUE(watch_.any_matched());
  EXPECT_TRUE(wakeup_.wait(0ns));
}

TEST_F(Watched, WritersOfSeveralRegionsAreToldApart) {
  std::map<Guid, core::RegionId> homes = {{writer(1), core::RegionId{1}}};
  ReaderWatch watch(wakeup_, [&](const Guid& guid) {
    const auto home = homes.find(guid);
    return home == homes.end() ? std::nullopt : std::optional(home->second);
  });
  for (const unsigned char number : {1, 2, 3}) {
    SubscriptionMatchedStatus status;
    status.current_count_change = 1;
    status.last_publication_handle = writer(number);
    watch.on_subscription_matched(nullptr, status);
  }
  homes[writer(2)] = core::RegionId{2};  // known only after the match
  EXPECT_EQ(watch.latest({}, core::RegionId{1}).guid, writer(1));
  EXPECT_EQ(watch.latest({}, core::RegionId{2}).guid, writer(2));
  EXPECT_EQ(watch.latest({}, core::RegionId{3}).order, 0U);
  EXPECT_EQ(watch.latest(writer(1).guidPrefix, core::RegionId{2}).order, 0U);
  EXPECT_TRUE(watch.any_matched({}, core::RegionId{2}));
  EXPECT_FALSE(watch.any_matched({}, core::RegionId{3}));
  EXPECT_FALSE(watch.any_matched(writer(3).guidPrefix, core::RegionId{1}));
}

TEST_F(Watched, SilenceIsBelievedAfterTheGraceTime) {
  match(writer(1));
  live(writer(1), 1);
  live(writer(1), -1);
  EXPECT_TRUE(watch_.latest().lost) << "no grace time was set";
  live(writer(1), 1);
  EXPECT_FALSE(watch_.latest().lost);
  EXPECT_TRUE(watch_.latest().alive);
  watch_.set_grace(1h);
  live(writer(1), -1);
  EXPECT_FALSE(watch_.latest().lost) << "Fast DDS sometimes means another one";
  EXPECT_FALSE(watch_.latest().alive);
}

TEST_F(Watched, AnUnmatchedWriterIsLostAtOnce) {
  watch_.set_grace(1h);
  match(writer(1));
  live(writer(1), 1);
  match(writer(1), -1);
  EXPECT_TRUE(watch_.latest().lost);
  EXPECT_FALSE(watch_.any_matched());
}

TEST_F(Watched, TheEndOfAnOldWriterIsNotTheEndOfTheNewOne) {
  match(writer(1));
  live(writer(1), 1);
  match(writer(2));
  live(writer(2), 1);
  live(writer(1), -1);
  match(writer(1), -1);
  EXPECT_EQ(watch_.latest().guid, writer(2));
  EXPECT_FALSE(watch_.latest().lost);
  EXPECT_EQ(watch_.writers().size(), 2U);
  EXPECT_TRUE(watch_.writers()[0].lost);
}

TEST_F(Watched, AStrangersWriterIsNotTheNodes) {
  match(writer(1));
  live(writer(1), 1);
  match(writer(2));
  live(writer(2), 1);
  EXPECT_EQ(watch_.latest().guid, writer(1)) << "who was here first";
  EXPECT_EQ(watch_.latest(writer(2).guidPrefix).guid, writer(2));
  EXPECT_EQ(watch_.latest(writer(3).guidPrefix).order, 0U);
  EXPECT_TRUE(watch_.any_matched(writer(2).guidPrefix));
  EXPECT_FALSE(watch_.any_matched(writer(3).guidPrefix));
  match(writer(1), -1);
  EXPECT_EQ(watch_.latest().guid, writer(2));
  EXPECT_TRUE(watch_.latest(writer(1).guidPrefix).lost);
}

TEST_F(Watched, AWriterThatIsMatchedAnewIsAnotherMatch) {
  match(writer(1));
  match(writer(1), -1);
  match(writer(1));
  EXPECT_EQ(watch_.latest().order, 2U);
  EXPECT_FALSE(watch_.latest().lost);
}

TEST(UserData, SaysTheRegionAndNothingElseDoes) {
  const auto bytes = [](const std::string& text) { return std::vector<unsigned char>(text.begin(), text.end()); };
  EXPECT_EQ(region_in(user_data_of(core::RegionId{17})), 17);
  EXPECT_EQ(region_in({}), -1);
  EXPECT_EQ(region_in(bytes("region=")), -1);
  EXPECT_EQ(region_in(bytes("region=3x")), -1);
  EXPECT_EQ(region_in(bytes("region=-3")), -1);
  EXPECT_EQ(region_in(bytes("region=99999999999")), -1);
  EXPECT_EQ(region_in(bytes("something else")), -1);
}

}  // namespace
}  // namespace aurasim::dds
