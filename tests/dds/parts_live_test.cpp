// Large messages of two regions over datagrams of 1,400 bytes, as on links with an MTU of 1,500, of which many are
// lost.
#include <gtest/gtest.h>

#include "datagram_recorder.h"
#include "dds/guarding.h"
#include "rtps/datagram_check.h"
#include "run_endpoints.h"
#include "security/scratch_store.h"

namespace aurasim::dds {
namespace {

using namespace testing;  // NOLINT: endpoints
using Clock = std::chrono::steady_clock;

constexpr std::size_t kDatagram_B = 1400;  // qos/hosts.xml

Settings narrow_settings(double loss, std::uint64_t stream) {
  Settings settings = settings_for(own_domain(), "hosts.xml");
  settings.interfaces = {"127.0.0.1"};
  settings.impairment = {.loss = loss, .seed = 7};
  settings.impairment_stream = stream;
  return settings;
}

template <class One, class Other>
void wait_until_matched(One& one, Other& other) {
  std::jthread thread([&] { one.wait_until_matched(kDeadline); });
  other.wait_until_matched(kDeadline);
}

core::Outbox large_messages() {
  core::Outbox outbox;
  outbox.aura = messages::testing::batch_of(3000, core::RegionId{0});
  outbox.hand_offs.push_back(messages::testing::hand_off_of(200, core::RegionId{0}, core::RegionId{1}));
  return outbox;
}

/// Waits until the large messages have arrived, and nothing else.
void expect_large_messages(Peer& at) {
  ASSERT_TRUE(take_until(at, [&] { return !at.inbox.auras.empty() && !at.inbox.hand_offs.empty(); }))
      << at.inbox.auras.size() << ' ' << at.inbox.hand_offs.size();
  ASSERT_EQ(at.inbox.auras.size(), 1U);
  EXPECT_EQ(at.inbox.auras[0].updates.size(), 3000U);
  ASSERT_EQ(at.inbox.hand_offs.size(), 1U);
  EXPECT_TRUE(messages::testing::same(at.inbox.hand_offs[0], large_messages().hand_offs[0]));
  EXPECT_EQ(at.transport.counters().aura.refused.total(), 0U);
  EXPECT_EQ(at.transport.counters().migration.refused.total(), 0U);
}

const std::string kPart(1'000'000, 'x');

void expect_checkpoint(CheckpointBus& at) {
  std::vector<messages::Checkpoint> taken;
  ASSERT_TRUE(holds_in_time([&] {
    for (messages::Checkpoint& one : at.take()) taken.push_back(std::move(one));
    return !taken.empty();
  }));
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_TRUE(taken[0].octets == kPart);
}

messages::Checkpoint large_checkpoint() {
  return {core::RegionId{0}, messages::Checkpoint::Kind::kToKeep, 1, 5, kPart};
}

/// Sends one, as soon as its reader is known: with losses endpoints are matched seconds apart.
bool is_sent_in_time(CheckpointBus& from) {
  bool is_sent = false;
  return holds_in_time([&] { return is_sent |= from.send_to_keepers(large_checkpoint()) == 1; });
}

class PartsLive : public ::testing::Test {
 protected:
  void meet(double loss) {
    a_ = std::make_unique<RunEndpoints>(narrow_settings(loss, 1), 0, std::initializer_list<std::uint32_t>{1});
    b_ = std::make_unique<RunEndpoints>(narrow_settings(loss, 2), 1, std::initializer_list<std::uint32_t>{0});
    wait_until_matched(a_->peer.transport, b_->peer.transport);
    ASSERT_TRUE(holds_in_time([&] {
      a_->control.publish_status(messages::testing::status_of(0));
      b_->control.publish_status(messages::testing::status_of(1));
      return a_->control.statuses().size() == 2 && b_->control.statuses().size() == 2;
    }));
  }
  /// One large message of each kind from a to b, and the newest key frame to somebody who joins later.
  void exchange_large_messages() {
    const auto begin = Clock::now();
    a_->peer.transport.send(large_messages());
    ASSERT_TRUE(is_sent_in_time(a_->checkpoints));
    core::Replica key = messages::testing::replica_of(2000, core::RegionId{0});
    key.key_frame = true;
    key.removed.clear();
    for (key.stamp = 1; key.stamp <= 3; ++key.stamp) ASSERT_TRUE(a_->replicas.send(key));
    expect_large_messages(b_->peer);
    expect_checkpoint(b_->checkpoints);
    EXPECT_TRUE(newest_key_frame_comes(b_->replica_reader));
    std::cout << "all is there after " << std::chrono::duration<double, std::milli>(Clock::now() - begin).count()
              << " ms\n";
    ReplicaReader late(b_->peer.participant, RunEndpoints::observed());
    EXPECT_TRUE(newest_key_frame_comes(late));
  }
  static bool newest_key_frame_comes(ReplicaReader& reader) {
    bool is_there = false;
    return holds_in_time([&] {
      for (const core::Replica& one : reader.take()) is_there |= one.stamp == 3 && one.bodies.size() == 2000;
      return is_there;
    });
  }

  std::unique_ptr<RunEndpoints> a_, b_;
};

rtps::GuidPrefix prefix_of(Peer& peer) {
  return dds::prefix_of(peer.participant.domain().participant().guid().guidPrefix);
}

/// Judges what the writers of `from` have sent.
void expect_no_fragments(Peer& from) {
  std::size_t largest_B = 0, of_writers = 0;
  rtps::Findings findings;
  for (const Bytes& bytes : recorded_datagrams()) {
    if (rtps::check_datagram(bytes, findings)) continue;
    for (const rtps::Claim& claim : findings.claims) {
      if (rtps::is_built_in(claim.guid.entity) || claim.guid.prefix != prefix_of(from)) continue;
      EXPECT_NE(claim.kind, rtps::Claim::Kind::kFragments);
      largest_B = std::max(largest_B, bytes.size());
      ++of_writers;
    }
  }
  EXPECT_GT(of_writers, 100U) << "or this test shows nothing";
  EXPECT_GT(largest_B, kDatagram_B - 150);
  EXPECT_LE(largest_B, kDatagram_B);
}

TEST_F(PartsLive, AreNeverInFragments) {
  meet(0);
  constexpr std::size_t kBatches = 60;  // of one to four datagrams
  for (std::size_t auras = 0; auras < kBatches; ++auras) {
    a_->peer.send_batch(static_cast<core::Step>(auras), auras);
  }
  Peer& b = b_->peer;
  ASSERT_TRUE(take_until(b, [&] { return b.inbox.auras.size() == kBatches; }));
  for (std::size_t auras = 0; auras < kBatches; ++auras) EXPECT_EQ(b.inbox.auras[auras].updates.size(), auras);
  b.inbox = {};
  exchange_large_messages();
  expect_no_fragments(a_->peer);
}

std::uint64_t lost_of(Peer& peer) { return peer.participant.impairment().value().datagrams.lost; }

TEST_F(PartsLive, ArriveThoughAQuarterOfTheDatagramsIsLost) {
  meet(0.25);
  exchange_large_messages();
  EXPECT_GT(lost_of(a_->peer), 400U) << "or this test shows nothing";
}

/// A node sends while it has only some parts of what another one sends.
TEST_F(PartsLive, LeaveNothingInWhatIsSentMeanwhile) {
  meet(0.25);
  constexpr std::size_t kBatches = 10;  // of a round
  constexpr std::size_t kAnswers = 6;   // fewer would show nothing
  const core::AuraBatch header = messages::testing::batch_of(0, core::RegionId{1});
  core::Outbox small;  // with the octets of a part in it it would still fit into a datagram
  small.aura.source = header.source;
  small.aura.generation = header.generation;
  small.aura.map_version = header.map_version;
  Peer &a = a_->peer, &b = b_->peer;
  std::size_t sent = 0, answers = 0;
  // On a busy machine a whole round may have arrived before b looks for the second time.
  for (int round = 0; round < 100 && answers < kAnswers; ++round) {
    for (std::size_t i = 0; i < kBatches; ++i) a.send_batch(static_cast<core::Step>(sent++), 3000);
    ASSERT_TRUE(take_until(b, [&] {
      small.aura.stamp = static_cast<core::Step>(answers++);
      b.transport.send(small);
      return b.inbox.auras.size() == sent;
    }));
  }
  ASSERT_GE(answers, kAnswers);
  ASSERT_TRUE(take_until(a, [&] { return a.inbox.auras.size() == answers; })) << a.inbox.auras.size();
  for (const core::AuraBatch& batch : a.inbox.auras) EXPECT_TRUE(batch.updates.empty());
  EXPECT_EQ(a.transport.counters().aura.refused.total(), 0U);
}

/// Retransmissions are packed into fewer and larger datagrams there: a handshake has to fit into one.
TEST_F(PartsLive, ArriveWithKeysThoughAQuarterOfTheDatagramsIsLost) {
  security::ScratchStore scratch;
  std::vector<std::unique_ptr<Peer>> peers;
  for (std::uint32_t region = 0; region < 2; ++region) {
    scratch.store.add(security::member_of_region(region), std::chrono::days(10));
  }
  for (std::uint32_t region = 0; region < 2; ++region) {
    Settings settings = narrow_settings(0.25, region);
    settings.keys = scratch.store.files_of(security::member_of_region(region).name);
    peers.push_back(std::make_unique<Peer>(settings, region, std::initializer_list<std::uint32_t>{1 - region}));
  }
  Peer &a = *peers[0], &b = *peers[1];
  CheckpointBus from(a.participant, core::RegionId{0}), to(b.participant, core::RegionId{1});
  from.use_keepers({core::RegionId{1}}, 0);
  ASSERT_TRUE(holds_in_time([&] { return a.transport.all_matched() && b.transport.all_matched(); }))
      << rtps::text_of(guarded(a.participant).refused) << "; " << guarded(a.participant).passed << " passed";
  const auto begin = Clock::now();
  a.transport.send(large_messages());
  expect_large_messages(b);
  ASSERT_TRUE(is_sent_in_time(from));
  expect_checkpoint(to);
  std::cout << "all is there after " << std::chrono::duration<double, std::milli>(Clock::now() - begin).count()
            << " ms\n";
  EXPECT_GT(lost_of(a), 100U) << "or this test shows nothing";
}

}  // namespace
}  // namespace aurasim::dds
