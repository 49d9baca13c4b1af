// Neighbours that die, hang, dawdle and come back. The lease of aura writers in qos/aurasim.xml is 1 s.
#include <optional>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "child.h"
#include "dds/endpoints.h"
#include "dds/many_nodes.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::PeerChange;
using core::RegionId;
using testing::Child;
using testing::Peer;
using testing::take_until;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kParticipantLease = 5s;  // of qos/aurasim.xml, as the other: after it DDS forgets a dead process

/// Region 0 in this process, region 1 in a child.
class Neighbour : public ::testing::Test {
 protected:
  void meet(const std::string& mode, std::chrono::milliseconds time = 0ms) {
    here_ = std::make_unique<Peer>(own_domain(), 0, std::initializer_list<std::uint32_t>{1});
    start(mode, time);
    here_->transport.wait_until_matched(testing::kDeadline);
    ASSERT_EQ(there_->read_line(), "ready");
    ASSERT_TRUE(take_until(*here_, [&] { return !here_->inbox.auras.empty(); }));
    ASSERT_TRUE(here_->inbox.peers.empty());
  }

  void start(const std::string& mode, std::chrono::milliseconds time = 0ms) {
    there_ = std::make_unique<Child>(std::vector<std::string>{AURASIM_BINARY_DIR "/dds_peer_process",
                                                              std::to_string(own_domain()), "1", "0", mode,
                                                              std::to_string(time.count())});
  }

  bool wait_for_peer_events(std::size_t count, std::chrono::nanoseconds time_out = testing::kDeadline) {
    return take_until(
        *here_, [&] { return here_->inbox.peers.size() >= count; }, time_out);
  }

  void expect_event(std::size_t index, PeerChange change) {
    ASSERT_GT(here_->inbox.peers.size(), index);
    EXPECT_EQ(here_->inbox.peers[index].region, RegionId{1});
    EXPECT_EQ(here_->inbox.peers[index].change, change);
  }

  std::unique_ptr<Peer> here_;
  std::unique_ptr<Child> there_;
};

TEST_F(Neighbour, ThatIsKilledIsLostOnce) {
  meet("run");
  there_->kill(SIGKILL);
  ASSERT_TRUE(wait_for_peer_events(1));
  expect_event(0, PeerChange::kLost);
  EXPECT_FALSE(wait_for_peer_events(2, kParticipantLease + 500ms)) << "lost twice";
}

TEST_F(Neighbour, ThatComesBackJoinsAndIsHeardAgain) {
  meet("run");
  there_->kill(SIGKILL);
  ASSERT_TRUE(wait_for_peer_events(1));
  here_->inbox.clear();
  start("run");
  ASSERT_TRUE(wait_for_peer_events(1));
  expect_event(0, PeerChange::kJoined);
  here_->inbox.auras.clear();
  EXPECT_TRUE(take_until(*here_, [&] { return !here_->inbox.auras.empty(); }));
}

TEST_F(Neighbour, ThatRestartsBeforeItsLossShowsIsLostAndThenJoins) {
  meet("run");
  there_->kill(SIGKILL);
  start("run");
  ASSERT_TRUE(wait_for_peer_events(2));
  expect_event(0, PeerChange::kLost);
  expect_event(1, PeerChange::kJoined);
  EXPECT_FALSE(wait_for_peer_events(3, kParticipantLease + 500ms)) << "the end of the old process must not count again";
}

TEST_F(Neighbour, WhoseOwnerHangsIsLost) {
  meet("hang", 200ms);
  ASSERT_TRUE(wait_for_peer_events(1));
  expect_event(0, PeerChange::kLost);
}

TEST_F(Neighbour, WhoseOwnerGetsOnWithAComputationIsNotLostHoweverLongItTakes) {
  meet("computes", 200ms);
  EXPECT_FALSE(wait_for_peer_events(1, 6s)) << "its hang limit is 0.5 s, and the lease 1 s";
}

TEST_F(Neighbour, ThatIsStoppedIsLostAndJoinsWhenItGoesOn) {
  meet("run");
  there_->kill(SIGSTOP);
  ASSERT_TRUE(wait_for_peer_events(1));
  expect_event(0, PeerChange::kLost);
  there_->kill(SIGCONT);
  ASSERT_TRUE(wait_for_peer_events(2));
  expect_event(1, PeerChange::kJoined);
  here_->inbox.auras.clear();
  EXPECT_TRUE(take_until(*here_, [&] { return !here_->inbox.auras.empty(); }));
}

/// A launcher on this host knows which processes live. Busy ones may be silent for many leases.
class SilentNeighbour : public Neighbour {
 protected:
  void meet_without_belief_in_silence() {
    Settings settings = testing::settings_for(own_domain());
    settings.believes_silence = false;
    here_ = std::make_unique<Peer>(settings, 0, std::initializer_list<std::uint32_t>{1});
    control_.emplace(here_->participant, ControlSettings{.region_count = 16});
    start("watched");
    here_->transport.wait_until_matched(testing::kDeadline);
    ASSERT_EQ(there_->read_line(), "ready");
    ASSERT_TRUE(take_until(*here_, [&] { return is_known() && !is_lost(); }));
  }
  bool is_known() { return control_->statuses().contains(RegionId{1}); }
  bool is_lost() { return control_->statuses().at(RegionId{1}).lost; }

  std::optional<ControlBus> control_;
};

TEST_F(SilentNeighbour, WhoseProcessIsThereIsNotLost) {
  ASSERT_NO_FATAL_FAILURE(meet_without_belief_in_silence());
  there_->kill(SIGSTOP);
  EXPECT_FALSE(take_until(
      *here_, [&] { return is_lost(); }, kParticipantLease + 2s));
  EXPECT_TRUE(here_->inbox.peers.empty());
  there_->kill(SIGCONT);
}

TEST_F(SilentNeighbour, WhoseProcessIsGoneIsLost) {
  ASSERT_NO_FATAL_FAILURE(meet_without_belief_in_silence());
  there_->kill(SIGKILL);
  EXPECT_TRUE(take_until(*here_, [&] { return is_lost(); }));
}

TEST_F(Neighbour, ThatTakesItsLeaveIsLostAtOnce) {
  // Leases of 10 s: a loss that is seen earlier is not one of silence.
  Settings settings = testing::settings_for(own_domain(), "hosts.xml");
  settings.interfaces = {"127.0.0.1"};
  here_ = std::make_unique<Peer>(settings, 0, std::initializer_list<std::uint32_t>{1});
  auto other = std::make_unique<Peer>(settings, 1, std::initializer_list<std::uint32_t>{0});
  other->transport.wait_until_matched(testing::kDeadline);
  here_->transport.wait_until_matched(testing::kDeadline);
  other->send_batch(0);
  ASSERT_TRUE(take_until(*here_, [&] { return !here_->inbox.auras.empty(); }));
  other.reset();
  ASSERT_TRUE(wait_for_peer_events(1, 9s));
  expect_event(0, PeerChange::kLost);
}

TEST_F(Neighbour, WithFramesLongerThanTheLeaseIsNotLost) {
  meet("long_frames");
  EXPECT_FALSE(wait_for_peer_events(1, 4s));
}

TEST_F(Neighbour, ThatIsDeadNeverBlocksASend) {
  meet("run");
  there_->kill(SIGKILL);
  core::Outbox outbox;
  outbox.aura = messages::testing::batch_of(100, RegionId{0});
  outbox.hand_offs = {messages::testing::hand_off_of(10, RegionId{0}, RegionId{1})};
  int slow = 0;
  const auto end = Clock::now() + 2s;
  while (Clock::now() < end) {
    const auto start = Clock::now();
    here_->transport.send(outbox);
    slow += Clock::now() - start > 200ms;
    here_->transport.take(here_->inbox);
    std::this_thread::sleep_for(5ms);
  }
  expect_event(0, PeerChange::kLost);
  EXPECT_EQ(here_->transport.counters().aura.send_failed, 0U);
  EXPECT_EQ(here_->transport.counters().migration.send_failed, 0U);
  EXPECT_LE(slow, 3) << "a send that blocks does so every time; a busy machine, once in a while";
}

/// A status writer of a watched node, which proves its life once, by a sample, and a reader of another such node.
struct ProvedOnce {
  explicit ProvedOnce(std::size_t nodes)
      : there(settings_of(nodes)),
        here(settings_of(nodes)),
        writer(there.domain(), on(TopicId::kNodeStatus, {.source = RegionId{1}}, RegionId{1}), there.domain().wakeup()),
        reader(here.domain(), on(TopicId::kNodeStatus), here.domain().wakeup()) {}

  static Settings settings_of(std::size_t nodes) {
    Settings settings = testing::settings_for(own_domain());
    settings.nodes = nodes;
    settings.believes_silence = false;
    settings.hang_limit = 1ms;
    return settings;
  }
  bool prove() {
    if (!testing::holds_in_time([&] { return reader.watch().any_matched() && writer.reader_count() == 1; }))
      return false;
    wire::NodeStatus status;
    writer.write(&status);
    return testing::holds_in_time([&] { return reader.watch().latest().alive; });
  }

  Participant there, here;
  Writer writer;
  Reader reader;
};

TEST(AWatchedNode, OfManyMayBeSilentForLongerThanItsLease) {
  ProvedOnce of_many(kManyNodes);
  ASSERT_TRUE(of_many.prove());
  std::this_thread::sleep_for(2s);
  EXPECT_TRUE(of_many.reader.watch().latest().alive);
}

TEST(AWatchedNode, OfFewShowsItsSilence) {
  ProvedOnce of_few(kManyNodes - 1);
  ASSERT_TRUE(of_few.prove());
  EXPECT_TRUE(testing::holds_in_time([&] { return !of_few.reader.watch().latest().alive; }));
}

}  // namespace
}  // namespace aurasim::dds
