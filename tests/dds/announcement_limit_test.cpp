// How often a participant is announced to each peer.
#include "rtps/announcement_limit.h"

#include <gtest/gtest.h>

#include "datagram_samples.h"
#include "dds/many_nodes.h"

namespace aurasim::rtps {
namespace {

using namespace std::chrono_literals;
using dds::testing::data;
using dds::testing::datagram;
using dds::testing::kEndpointWriter;
using dds::testing::kPrefix;
using dds::testing::Octets;
using dds::testing::participant;
using dds::testing::statistics;
using dds::testing::submessage;

Octets timestamp() { return submessage(0x09, 0, Octets().u32(1).u32(2)); }

TEST(AnAnnouncement, IsFoundByItsWriter) {
  const auto said = participant(kPrefix).bytes();
  EXPECT_EQ(announcement_in(datagram({timestamp(), data(kParticipantWriter, 7, said)})), 7U);
  EXPECT_EQ(announcement_in(datagram({timestamp(), data(kEndpointWriter, 7, said)})), std::nullopt);
  EXPECT_EQ(announcement_in(datagram({timestamp(), data(kParticipantWriter, 7, said), timestamp()})), std::nullopt)
      << "there is more in it";
  EXPECT_EQ(announcement_in(datagram({timestamp(), data(kParticipantWriter, 7, said), statistics()})), 7U);
  EXPECT_EQ(announcement_in(datagram({})), std::nullopt);
}

TEST(AnAnnouncement, ThatAParticipantLeavesIsNone) {
  auto leaves = datagram({data(kParticipantWriter, 7, participant(kPrefix).bytes())});
  leaves[21] = 0x09;  // a key instead of data
  EXPECT_EQ(announcement_in(leaves), std::nullopt);
}

class AnAnnouncementLimit : public ::testing::Test {
 protected:
  static Peer peer(std::uint32_t port) { return {1, {127, 0, 0, 1}, port}; }
  AnnouncementLimit limit_{100ms};
};

TEST_F(AnAnnouncementLimit, RepeatsNothingToOnePeerForSomeTime) {
  EXPECT_TRUE(limit_.allows(peer(7410), 1, 1s));
  EXPECT_FALSE(limit_.allows(peer(7410), 1, 1099ms));
  EXPECT_TRUE(limit_.allows(peer(7410), 1, 1100ms));
}

TEST_F(AnAnnouncementLimit, LetsANewPeerKnowAtOnce) {
  EXPECT_TRUE(limit_.allows(peer(7410), 1, 1s));
  EXPECT_TRUE(limit_.allows(peer(7412), 1, 1s));
}

TEST_F(AnAnnouncementLimit, LetsWhatHasChangedThroughAtOnce) {
  EXPECT_TRUE(limit_.allows(peer(7410), 1, 1s));
  EXPECT_TRUE(limit_.allows(peer(7410), 2, 1s));
}

TEST(ManyNodes, AreTenAndMore) {
  using dds::shortest_between_announcements, dds::shortest_heartbeat, topics::TopicId;
  EXPECT_EQ(shortest_between_announcements(9), 0ns);
  EXPECT_EQ(shortest_between_announcements(64), 640ms);
  EXPECT_EQ(shortest_heartbeat(TopicId::kNodeStatus, 9), 0ns);
  EXPECT_EQ(dds::shortest_announcement_period(9), 0ns);
  EXPECT_EQ(dds::shortest_announcement_period(64), 2560ms);
  EXPECT_EQ(shortest_heartbeat(TopicId::kNodeStatus, 64), 2560ms);
  EXPECT_EQ(shortest_heartbeat(TopicId::kRegionMap, 64), 640ms);
  EXPECT_FALSE(dds::is_renewed_sparsely(9, false));
  EXPECT_FALSE(dds::is_renewed_sparsely(64, true)) << "silence may be a death";
  EXPECT_TRUE(dds::is_renewed_sparsely(64, false));
  EXPECT_EQ(shortest_heartbeat(TopicId::kRunControl, 64), 100ms);
  EXPECT_EQ(shortest_heartbeat(TopicId::kAura, 64), 20ms);
  for (const TopicId topic : {TopicId::kMigration, TopicId::kSeam}) {
    EXPECT_EQ(shortest_heartbeat(topic, 64), 0ns) << "a step waits for it";
  }
}

}  // namespace
}  // namespace aurasim::rtps
