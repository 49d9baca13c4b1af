// Two and more regions that really talk over DDS on loopback.
#include <algorithm>
#include <map>
#include <mutex>
#include <set>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "aurasimPubSubTypes.h"
#include "dds/dds_transport.h"
#include "dds/domain.h"
#include "dds/endpoints.h"
#include "dds/participant_qos.h"
#include "messages/codec.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using messages::testing::batch_of;
using messages::testing::hand_off_of;
using messages::testing::same;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Peer;
using testing::take_until;
using ::testing::UnorderedElementsAre;
using namespace std::chrono_literals;

/// Matches all; they wait at once, as nodes would.
void match(std::initializer_list<Peer*> peers) {
  std::vector<std::jthread> threads;
  for (Peer* peer : peers) {
    threads.emplace_back([peer] { peer->transport.wait_until_matched(testing::kDeadline); });
  }
}

TEST(TwoRegions, ExchangeAurasAndHandOffsToTheBit) {
  Peer a(own_domain(), 0, {1});
  Peer b(own_domain(), 1, {0});
  match({&a, &b});

  core::Outbox from_b;
  from_b.aura = batch_of(1000, RegionId{1});
  from_b.hand_offs = {hand_off_of(20, RegionId{1}, RegionId{0})};
  b.transport.send(from_b);
  ASSERT_TRUE(take_until(a, [&] { return !a.inbox.auras.empty() && !a.inbox.hand_offs.empty(); }));
  EXPECT_TRUE(same(a.inbox.auras.at(0), from_b.aura));
  EXPECT_TRUE(same(a.inbox.hand_offs.at(0), from_b.hand_offs[0]));

  core::Outbox from_a;
  from_a.aura = batch_of(0, RegionId{0});
  a.transport.send(from_a);
  ASSERT_TRUE(take_until(b, [&] { return !b.inbox.auras.empty(); }));
  EXPECT_TRUE(same(b.inbox.auras.at(0), from_a.aura));

  EXPECT_EQ(b.transport.counters().aura.sent, 1U);
  EXPECT_EQ(b.transport.counters().aura.sent_bytes, a.transport.counters().aura.received_bytes);
  EXPECT_EQ(a.transport.counters().migration.received, 1U);
  EXPECT_EQ(a.transport.counters().aura.refused.total(), 0U);
}

TEST(TwoRegions, LoseNothingOfALongStreamAndKeepItsOrder) {
  Peer a(own_domain(), 0, {1});
  Peer b(own_domain(), 1, {0});
  match({&a, &b});
  constexpr std::size_t kSteps = 3000;
  for (std::size_t step = 0; step < kSteps; ++step) {
    b.send_batch(static_cast<core::Step>(step), step % 200);
    a.transport.take(a.inbox);
  }
  ASSERT_TRUE(take_until(a, [&] { return a.inbox.auras.size() >= kSteps; }));
  EXPECT_TRUE(std::ranges::is_sorted(a.inbox.auras, {}, &core::AuraBatch::stamp));
  EXPECT_EQ(a.inbox.auras.size(), kSteps);
  EXPECT_EQ(b.transport.counters().aura.send_failed, 0U);
}

TEST(TwoRegions, RefuseEachOthersMessagesWhenTheirMapsDiffer) {
  Peer a(own_domain(), 0, {1});
  Peer b(own_domain(), 1, {0});
  match({&a, &b});
  core::Outbox outbox;
  outbox.aura = batch_of(1, RegionId{1});
  outbox.aura.map_version = 1;
  b.transport.send(outbox);
  ASSERT_TRUE(take_until(a, [&] { return a.transport.counters().aura.received > 0; }));
  EXPECT_TRUE(a.inbox.auras.empty());
  EXPECT_EQ(a.transport.counters().aura.refused.count(messages::WireError::kMapVersion), 1U);
}

TEST(ARow, HearsNeighboursOnly) {
  Peer left(own_domain(), 0, {1});
  Peer middle(own_domain(), 1, {0, 2});
  Peer right(own_domain(), 2, {1});
  match({&left, &middle, &right});
  left.send_batch(1);
  right.send_batch(1);
  middle.send_batch(1);
  ASSERT_TRUE(take_until(middle, [&] { return middle.inbox.auras.size() == 2; }));
  ASSERT_TRUE(take_until(left, [&] { return !left.inbox.auras.empty(); }));
  EXPECT_FALSE(take_until(
      left, [&] { return left.inbox.auras.size() > 1; }, 200ms));
  EXPECT_EQ(left.inbox.auras.at(0).source, RegionId{1});
}

/// Sees what readers announce: topic and partitions of each.
class Onlooker : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant*,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override {
    if (info.status != eprosima::fastrtps::rtps::ReaderDiscoveryInfo::DISCOVERED_READER) {
      return;
    }
    const std::lock_guard lock(mutex_);
    seen_.emplace(info.info.topicName().to_string(), info.info.m_qos.m_partition.names());
  }
  std::multimap<std::string, std::vector<std::string>> seen() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  mutable std::mutex mutex_;
  std::multimap<std::string, std::vector<std::string>> seen_;
};

TEST(Readers, AreOneForEachTopicAndNameOnlyTheNeighboursPartitions) {
  Onlooker onlooker;
  const Settings settings = testing::settings_for(own_domain());
  Profiles profiles(settings.profiles);
  auto* factory = eprosima::fastdds::dds::DomainParticipantFactory::get_instance();
  auto* participant = factory->create_participant(settings.domain, participant_qos(profiles, settings), &onlooker,
                                                  eprosima::fastdds::dds::StatusMask::none());
  ASSERT_NE(participant, nullptr);
  {
    const Peer four(own_domain(), 4, {1, 3, 7});
    const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
    while (onlooker.seen().size() < 3 && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(10ms);
    }
  }
  factory->delete_participant(participant);
  using Row = std::pair<const std::string, std::vector<std::string>>;
  EXPECT_THAT(onlooker.seen(), UnorderedElementsAre(Row("aura", {"region/1", "region/3", "region/7"}),
                                                    Row("migration", {"region/*/to/4"})));
}

/// Regions that were no neighbours at first hear each other's batches, and need no more until bodies go there.
TEST(ALaterRegion, GetsItsFirstHandOffAndAnswers) {
  Peer a(own_domain(), 0, {1});
  Peer b(own_domain(), 1, {0});
  Peer far(own_domain(), 2, {});
  match({&a, &b});
  core::Outbox from_a;
  from_a.aura = batch_of(0, RegionId{0});
  from_a.expected = {RegionId{2}};
  a.transport.send(from_a);
  core::Outbox from_far;
  from_far.aura = batch_of(0, RegionId{2});
  from_far.expected = {RegionId{0}};
  far.transport.send(from_far);
  match({&a, &far});
  EXPECT_EQ(a.transport.found(), 4U + 2U);

  from_a.expected.clear();
  from_a.listeners = {RegionId{1}, RegionId{2}};
  from_a.hand_offs = {hand_off_of(20, RegionId{0}, RegionId{2})};
  a.transport.send(from_a);
  ASSERT_TRUE(take_until(far, [&] { return !far.inbox.hand_offs.empty() && !far.inbox.auras.empty(); }));
  EXPECT_TRUE(same(far.inbox.hand_offs.at(0), from_a.hand_offs[0]));
  EXPECT_EQ(a.transport.found(), 4U + 3U);

  from_far.expected.clear();
  from_far.aura.adopted = {{RegionId{0}, 1}};
  from_far.listeners = {RegionId{0}};
  far.transport.send(from_far);
  // The batch that `far` published before it knew `a` may come first.
  EXPECT_TRUE(take_until(a, [&] { return !a.inbox.auras.empty() && same(a.inbox.auras.back(), from_far.aura); }));
  ASSERT_TRUE(take_until(b, [&] { return b.inbox.auras.size() == 2; }));
  EXPECT_TRUE(b.inbox.hand_offs.empty());
  EXPECT_EQ(b.transport.counters().migration.received, 0U) << "what is for one receiver goes to no other";
}

/// A batch goes to nobody who has left, so it costs nothing there.
TEST(ALaterRegion, HearsNothingAfterItHasLeftAndAllWhenItComesBack) {
  Peer a(own_domain(), 0, {1});
  Peer b(own_domain(), 1, {0});
  Peer far(own_domain(), 2, {});
  match({&a, &b});
  core::Step stamp = 0;
  struct Who {
    std::vector<RegionId> listeners = {}, expected = {}, left = {};
  };
  const auto send = [&stamp](Peer& from, const Who& who) {
    core::Outbox outbox;
    outbox.listeners = who.listeners;
    outbox.expected = who.expected;
    outbox.left = who.left;
    outbox.aura = batch_of(0, from.region());
    outbox.aura.stamp = ++stamp;
    from.transport.send(outbox);
  };
  const auto meet = [&] {
    send(a, {.expected = {RegionId{2}}});
    send(far, {.expected = {RegionId{0}}});
    match({&a, &far});
  };
  meet();
  send(a, {.listeners = {RegionId{1}, RegionId{2}}});
  ASSERT_TRUE(take_until(far, [&] { return !far.inbox.auras.empty() && far.inbox.auras.back().stamp == stamp; }));

  send(far, {.left = {RegionId{0}}});
  send(a, {.listeners = {RegionId{1}}, .left = {RegionId{2}}});
  EXPECT_EQ(a.transport.found(), 4U);
  far.inbox = {};
  for (int i = 0; i < 3; ++i) send(a, {.listeners = {RegionId{1}}});
  ASSERT_TRUE(take_until(b, [&] { return !b.inbox.auras.empty() && b.inbox.auras.back().stamp == stamp; }));
  far.transport.take(far.inbox);
  EXPECT_TRUE(far.inbox.auras.empty());

  meet();
  send(a, {.listeners = {RegionId{1}, RegionId{2}}});
  EXPECT_TRUE(take_until(far, [&] { return !far.inbox.auras.empty() && far.inbox.auras.back().stamp == stamp; }));
}

TEST(Waiting, NamesTheRegionsThatAreMissing) {
  Peer a(own_domain(), 0, {1, 2, 3});
  Peer b(own_domain(), 1, {0});
  b.transport.wait_until_matched(testing::kDeadline);
  try {
    a.transport.wait_until_matched(1s);
    FAIL() << "regions 2 and 3 are not there";
  } catch (const NeighboursMissing& missing) {
    EXPECT_THAT(missing.regions(), ElementsAre(RegionId{2}, RegionId{3}));
    EXPECT_THAT(missing.what(),
                HasSubstr("region 0 has waited in vain for region 2 (nothing received from it), region 3"));
    EXPECT_THAT(missing.what(), Not(HasSubstr("region 1")));
  }
  EXPECT_FALSE(a.transport.all_matched());
}

TEST(Waiting, NamesAOneSidedNeighbour) {
  Peer a(own_domain(), 0, {1});
  Peer b(own_domain(), 1, {2});  // does not listen to region 0
  try {
    a.transport.wait_until_matched(1s);
    FAIL() << "region 1 does not listen";
  } catch (const NeighboursMissing& missing) {
    EXPECT_THAT(missing.what(), HasSubstr("region 1 (its aura reader, its migration writer"));
    EXPECT_THAT(missing.what(), Not(HasSubstr("its aura writer")));
  }
}

TEST(Domains, DoNotSeeEachOther) {
  Peer a(own_domain(0), 0, {1});
  Peer b(own_domain(1), 1, {0});
  EXPECT_THROW(a.transport.wait_until_matched(1s), NeighboursMissing);
  EXPECT_THROW(b.transport.wait_until_matched(100ms), NeighboursMissing);
}

/// A writer of region 1's auras that writes bytes of its own, as a broken or hostile process could.
class RawAuras final : public wire::AuraBatchPubSubType {
 public:
  RawAuras() {
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    if (!wire::AuraBatchPubSubType::serialize(data, payload)) {
      return false;
    }
    if (static_cast<wire::AuraBatch*>(data)->violations() == 1) {
      constexpr std::size_t kFullAt = 4 + 40;  // the boolean; 7 is neither true nor false and makes fastcdr throw
      payload->data[kFullAt] = 7;
    }
    return true;
  }
};

TEST(AMalformedSample, IsCountedAndTheNextOneStillArrives) {
  Peer a(own_domain(), 0, {1});
  const Settings settings = testing::settings_for(own_domain());
  Profiles profiles(settings.profiles);
  auto* factory = eprosima::fastdds::dds::DomainParticipantFactory::get_instance();
  auto* participant = factory->create_participant(settings.domain, participant_qos(profiles, settings));
  ASSERT_NE(participant, nullptr);
  eprosima::fastdds::dds::TypeSupport type(new RawAuras());
  type.register_type(participant);
  auto* topic = participant->create_topic("aura", type.get_type_name(), eprosima::fastdds::dds::TOPIC_QOS_DEFAULT);
  eprosima::fastdds::dds::PublisherQos publisher_qos;
  publisher_qos.partition().push_back("region/1");
  auto* publisher = participant->create_publisher(publisher_qos);
  auto* writer = publisher->create_datawriter(topic, profiles.writer(*publisher, "aura_writer"));
  ASSERT_NE(writer, nullptr);
  const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
  eprosima::fastdds::dds::PublicationMatchedStatus matched;
  while (matched.current_count == 0 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(10ms);
    writer->get_publication_matched_status(matched);
  }

  wire::AuraBatch sample;
  core::AuraBatch batch = batch_of(3, RegionId{1});
  for (const std::uint64_t violations : {0U, 1U, 2U}) {
    batch.violations = violations;
    messages::encode(batch, sample);
    writer->write(&sample);
  }
  EXPECT_TRUE(take_until(a, [&] { return a.transport.counters().aura.received == 3; }));
  EXPECT_EQ(a.transport.counters().aura.refused.count(messages::WireError::kMalformed), 1U);
  ASSERT_EQ(a.inbox.auras.size(), 2U);
  EXPECT_EQ(a.inbox.auras[1].violations, 2U);
  participant->delete_contained_entities();
  factory->delete_participant(participant);
}

TEST(Settings, ThatMakeNoSenseAreRefused) {
  Participant participant(testing::settings_for(own_domain()));
  const auto make = [&](std::uint32_t region, std::initializer_list<std::uint32_t> neighbours) {
    DdsTransport transport(participant, {.region = static_cast<RegionId>(region),
                                         .neighbours = testing::regions(neighbours),
                                         .map_version = 1,
                                         .region_count = 4});
  };
  EXPECT_THROW(make(4, {}), std::invalid_argument);
  EXPECT_THROW(make(1, {1}), std::invalid_argument);
  EXPECT_THROW(make(1, {0, 0}), std::invalid_argument);
  EXPECT_THROW(make(1, {4}), std::invalid_argument);
}

}  // namespace
}  // namespace aurasim::dds
