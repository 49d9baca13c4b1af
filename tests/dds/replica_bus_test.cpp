// Nodes publish, observers listen.
#include "dds/replica_bus.h"

#include <gtest/gtest.h>

#include "messages/replica_messages.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using messages::testing::replica_of;
using testing::holds_in_time;
using testing::settings_for;

struct Observer {
  explicit Observer(std::uint32_t domain)
      : participant(settings_for(domain)), reader(participant, {testing::kMapVersion, 4, 7}) {}

  /// Takes until there are `count`; false at the deadline.
  bool take(std::size_t count) {
    const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
    while (replicas.size() < count && std::chrono::steady_clock::now() < deadline) {
      reader.wait(std::chrono::milliseconds(20));
      for (core::Replica& replica : reader.take()) replicas.push_back(std::move(replica));
    }
    return replicas.size() >= count;
  }

  Participant participant;
  ReplicaReader reader;
  std::vector<core::Replica> replicas;
};

TEST(ReplicaBus, ALateObserverGetsTheLastKeyFrameAndWhatIsToldFromThenOn) {
  Participant participant(settings_for(own_domain()));
  ReplicaWriter writer(participant, RegionId{1});
  EXPECT_FALSE(writer.anybody_listens());
  core::Replica key = replica_of(3);
  key.key_frame = true;
  writer.send(key);
  key.sequence = 34;
  writer.send(key);
  Observer observer(own_domain());
  ASSERT_TRUE(holds_in_time([&] { return writer.arrivals() == 2; }));
  EXPECT_TRUE(writer.anybody_listens());
  ASSERT_TRUE(observer.take(1));
  EXPECT_TRUE(observer.replicas[0].key_frame);
  EXPECT_EQ(observer.replicas[0].sequence, 34U);
  writer.send(replica_of(2));
  ASSERT_TRUE(observer.take(2));
  EXPECT_FALSE(observer.replicas[1].key_frame);
  EXPECT_EQ(observer.replicas[1].bodies.size(), 2U);
}

TEST(ReplicaBus, WhoTakesARegionOverBeforeItsStatusIsHeardIsHeardFromItsLastKeyFrameOn) {
  Participant old_node(settings_for(own_domain())), new_node(settings_for(own_domain()));
  ReplicaWriter writer(new_node, RegionId{1});
  Observer observer(own_domain());
  Speakers& speakers = observer.participant.domain().speakers();
  speakers.set(RegionId{1}, old_node.domain().participant().guid().guidPrefix);
  ASSERT_TRUE(holds_in_time([&] { return writer.arrivals() == 2; }));
  core::Replica key = replica_of(3);
  key.key_frame = true;
  writer.send(key);
  ASSERT_TRUE(holds_in_time([&] { return observer.reader.take().empty() && speakers.refused() == 1; }));
  speakers.set(RegionId{1}, new_node.domain().participant().guid().guidPrefix);
  ASSERT_TRUE(observer.take(1));
  EXPECT_TRUE(observer.replicas[0].key_frame);
  EXPECT_EQ(observer.reader.received(), 1U);
}

TEST(ReplicaBus, AnObserverThatDoesNotTakeHoldsNobodyUp) {
  Participant participant(settings_for(own_domain()));
  ReplicaWriter writer(participant, RegionId{1});
  Observer observer(own_domain());
  ASSERT_TRUE(holds_in_time([&] { return writer.arrivals() == 2; }));
  const core::Replica replica = replica_of(100);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 2000; ++i) EXPECT_TRUE(writer.send(replica));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

}  // namespace
}  // namespace aurasim::dds
