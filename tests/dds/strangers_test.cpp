// Processes that speak in the name of others, over DDS: what they say does nothing to those whose name they use.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "aurasim.h"
#include "core/mesh_hash.h"
#include "dds/command_bus.h"
#include "dds/random_id.h"
#include "dds/scene_additions_bus.h"
#include "dds/typed_endpoints.h"
#include "messages/codec.h"
#include "messages/control_codec.h"
#include "messages/control_samples.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using messages::testing::batch_of;
using messages::testing::command_of;
using messages::testing::hand_off_of;
using messages::testing::status_of;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::holds_in_time;
using ::testing::IsEmpty;
using testing::Peer;
using testing::take_until;
using namespace std::chrono_literals;

/// Has any command come by then?
bool take_any(ControlBus& bus, std::vector<messages::RunCommand>& taken, std::chrono::milliseconds time_out) {
  const auto deadline = std::chrono::steady_clock::now() + time_out;
  while (taken.empty() && std::chrono::steady_clock::now() < deadline) {
    for (messages::RunCommand& command : bus.take_commands()) taken.push_back(std::move(command));
    bus.wait(10ms);
  }
  return !taken.empty();
}

/// In run 11.
ControlSettings node_of(std::uint32_t region, std::uint32_t regions) {
  ControlSettings settings;
  settings.region = RegionId{region};
  settings.run = 11;
  settings.region_count = regions;
  return settings;
}

/// Nodes 0 and 1, that listen to each other, and somebody.
class AStranger : public ::testing::Test {
 protected:
  AStranger() {
    publish(zero_bus_, 0);
    publish(one_bus_, 1);
    std::jthread other([this] { one_.transport.wait_until_matched(testing::kDeadline); });
    zero_.transport.wait_until_matched(testing::kDeadline);
    EXPECT_TRUE(holds_in_time([&] { return zero_bus_.statuses().size() == 2; }));
  }

  static ControlSettings settings(std::uint32_t region) {
    ControlSettings settings = node_of(region, 2);
    settings.agreement = 88;
    return settings;
  }
  static messages::Status of_this_host(std::uint32_t region) {
    messages::Status status = status_of(region);
    status.pid = static_cast<std::uint32_t>(::getpid());
    status.process = 100 + region;
    return status;
  }
  static void publish(ControlBus& bus, std::uint32_t region) { bus.publish_status(of_this_host(region)); }

  template <class Wire>
  std::unique_ptr<TypedWriter<Wire>> writer(TopicId topic, const topics::Route& route = {},
                                            std::optional<RegionId> region = {}) {
    auto writer = std::make_unique<TypedWriter<Wire>>(stranger_.domain(), on(topic, route, region), wakeup_);
    EXPECT_TRUE(holds_in_time([&] { return writer->reader_count() > 0; })) << name_of(topic);
    return writer;
  }
  static core::AuraBatch forged_batch() {
    core::AuraBatch batch = batch_of(2, RegionId{1});
    batch.stamp = 3;
    return batch;
  }
  /// The node of region 1 says that it is a process which is not there. True once the node of region 0 knows.
  bool shows_a_process_that_is_gone() {
    messages::Status gone = of_this_host(1);
    gone.pid = 0x7fff'ffffU;  // above any that Linux gives
    return one_bus_.publish_status(gone) &&
           holds_in_time([&] { return zero_bus_.statuses().at(RegionId{1}).status.pid == gone.pid; });
  }
  std::string said() {
    for (std::string& text : zero_.participant.take_said()) said_ += text + "\n";
    return said_;
  }

  Peer zero_{own_domain(), 0, {1}};
  Peer one_{own_domain(), 1, {0}};
  ControlBus zero_bus_{zero_.participant, settings(0)};
  ControlBus one_bus_{one_.participant, settings(1)};
  Participant stranger_{testing::settings_for(own_domain())};
  Wakeup wakeup_;
  std::string said_;
};

TEST_F(AStranger, WithAnAuraWriterIsNotTheEndOfARegion) {
  const auto auras = writer<wire::AuraBatch>(TopicId::kAura, {.source = RegionId{1}}, RegionId{1});
  auras->send(forged_batch());
  one_.send_batch(5);
  ASSERT_TRUE(take_until(zero_, [&] { return zero_.transport.counters().aura.received == 2; }));
  ASSERT_EQ(zero_.inbox.auras.size(), 1U);
  EXPECT_EQ(zero_.inbox.auras[0].stamp, 5);
  EXPECT_THAT(zero_.inbox.peers, IsEmpty());
  EXPECT_THAT(zero_.inbox.refusals, IsEmpty());
  EXPECT_EQ(zero_.participant.refused_of_strangers(), 1U);
  EXPECT_THAT(said(), HasSubstr("aura: it is not the node of region 1"));
}

TEST_F(AStranger, HandsNothingOverAndEndsNobodyByWhatCannotBe) {
  const auto hand_offs =
      writer<wire::Migration>(TopicId::kMigration, {.source = RegionId{1}, .destination = RegionId{0}}, RegionId{1});
  core::HandOff forged = hand_off_of(2);
  hand_offs->send(forged);
  forged.cluster.bodies[0].v_WB.x() = 1e308;
  hand_offs->send(forged);
  ASSERT_TRUE(take_until(zero_, [&] { return zero_.transport.counters().migration.received == 2; }));
  EXPECT_THAT(zero_.inbox.hand_offs, IsEmpty());
  EXPECT_THAT(zero_.inbox.refusals, IsEmpty()) << "the region that it names would be held for dead";
  EXPECT_EQ(zero_.participant.refused_of_strangers(), 2U);
}

TEST_F(AStranger, IsNotListenedToAnyMoreAfterAHundredLies) {
  const auto auras = writer<wire::AuraBatch>(TopicId::kAura, {.source = RegionId{1}}, RegionId{1});
  for (int i = 0; i < 150; ++i) auras->send(forged_batch());
  EXPECT_TRUE(take_until(zero_, [&] { return said().find("not listened to any more") != std::string::npos; }));
  one_.send_batch(5);
  ASSERT_TRUE(take_until(zero_, [&] { return !zero_.inbox.auras.empty(); }));
  EXPECT_EQ(zero_.participant.refused_of_strangers(), 100U);
}

TEST_F(AStranger, SpeaksOfNoRegionThatTheRunHasNot) {
  const auto statuses = writer<wire::NodeStatus>(TopicId::kNodeStatus, {.source = RegionId{9}}, RegionId{9});
  statuses->send(of_this_host(9));
  ASSERT_TRUE(holds_in_time([&] { return zero_bus_.strangers().size() == 1; }));
  EXPECT_EQ(zero_bus_.statuses().size(), 2U);
}

TEST_F(AStranger, IsNotTheNodeOfARegionThatHasOne) {
  const auto statuses = writer<wire::NodeStatus>(TopicId::kNodeStatus, {.source = RegionId{1}}, RegionId{1});
  messages::Status forged = of_this_host(1);
  forged.process = 666;
  statuses->send(forged);
  ASSERT_TRUE(holds_in_time([&] {
    zero_bus_.statuses();
    return zero_.participant.refused_of_strangers() == 1;
  }));
  EXPECT_EQ(zero_bus_.statuses().at(RegionId{1}).status.process, 101U);
  EXPECT_THAT(said(), HasSubstr("region 1 has another node"));
}

TEST_F(AStranger, SpeaksOfNoRegionBesideItsPartition) {
  const auto statuses = writer<wire::NodeStatus>(TopicId::kNodeStatus, {.source = RegionId{1}}, RegionId{1});
  statuses->send(of_this_host(0));
  ASSERT_TRUE(holds_in_time([&] {
    zero_bus_.statuses();
    return zero_.participant.refused_of_strangers() == 1;
  }));
  EXPECT_THAT(said(), HasSubstr("publishes a status of region 0 in the partition of another"));
}

TEST_F(AStranger, SaysOnlyWhatOperatorsMay) {
  const auto runs = writer<wire::RunControl>(TopicId::kRunControl);
  messages::RunCommand command;
  command.run = 11;
  using Kind = messages::RunCommandKind;
  for (const Kind kind : {Kind::kStart, Kind::kRate, Kind::kRestore, Kind::kEnd, Kind::kPause}) {
    command.kind = kind;
    command.request = draw_id();
    runs->send(command, std::uint64_t{7});
  }
  std::vector<messages::RunCommandKind> taken;
  ASSERT_TRUE(holds_in_time([&] {
    for (const messages::RunCommand& one : zero_bus_.take_commands()) taken.push_back(one.kind);
    return !taken.empty();
  }));
  EXPECT_THAT(taken, ElementsAre(Kind::kPause));
  const auto refused = [&] {
    zero_bus_.take_commands();
    return zero_.participant.refused_of_strangers();
  };
  EXPECT_TRUE(holds_in_time([&] { return refused() == 4U; })) << refused();
}

/// A drain gives a region a second process, which waits for the first to leave.
TEST(AProcessThatHasJustBegun, TakesWhoActsForARegionsNodeThoughItsSuccessorIsHeardFirst) {
  Participant first(testing::settings_for(own_domain())), second(testing::settings_for(own_domain()));
  Participant participant(testing::settings_for(own_domain()));
  ControlBus node(first, node_of(1, 2)), successor(second, node_of(1, 2)), newcomer(participant, node_of(0, 2));
  messages::Status waits = status_of(1);
  waits.state = messages::NodeState::kSpare;
  waits.process = 2;
  successor.publish_status(waits);
  ASSERT_TRUE(holds_in_time([&] { return newcomer.statuses().contains(RegionId{1}); }));
  messages::Status acts = status_of(1);
  acts.state = messages::NodeState::kRecovering;
  acts.process = 1;
  node.publish_status(acts);
  EXPECT_TRUE(holds_in_time([&] { return newcomer.statuses().at(RegionId{1}).status.process == 1; }));
  successor.publish_status(waits);
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(newcomer.statuses().at(RegionId{1}).status.process, 1U);
  EXPECT_THAT(participant.take_said(), IsEmpty());
}

/// One is at its end some states before another. A process that waits beside it, whoever that is, was taken for its
/// successor then, and the run went back to where it had begun.
TEST(ANodeThatHasComeToTheEnd, IsItsRegionsNodeUntilItHasLeft) {
  auto first = std::make_unique<Participant>(testing::settings_for(own_domain()));
  Participant second(testing::settings_for(own_domain())), participant(testing::settings_for(own_domain()));
  auto node = std::make_unique<ControlBus>(*first, node_of(1, 2));
  ControlBus waiting(second, node_of(1, 2)), other(participant, node_of(0, 2));
  messages::Status acts = status_of(1);
  acts.process = 1;
  node->publish_status(acts);
  ASSERT_TRUE(holds_in_time([&] { return other.statuses().contains(RegionId{1}); }));
  messages::Status waits = status_of(1);
  waits.state = messages::NodeState::kSpare;
  waits.process = 2;
  const auto seen = [&] { return other.statuses().at(RegionId{1}).status; };
  const auto publish_for = [&](std::chrono::milliseconds time) {
    for (auto waited = 0ms; waited < time; waited += 50ms) {
      node->publish_status(acts);
      waiting.publish_status(waits);
      std::this_thread::sleep_for(50ms);
      EXPECT_EQ(seen().process, 1U);
    }
  };
  publish_for(500ms);
  acts.state = messages::NodeState::kFinished;
  publish_for(500ms);
  EXPECT_EQ(seen().state, messages::NodeState::kFinished);
  node.reset();
  first.reset();
  EXPECT_TRUE(holds_in_time([&] { return seen().process == 2U; }));
}

/// It is told where all go back to within a tenth of a second of its beginning.
TEST(AProcessThatHasJustBegun, TakesTheWordOfANodeThatItDoesNotYetKnow) {
  std::vector<std::unique_ptr<Participant>> participants;
  std::vector<std::unique_ptr<ControlBus>> buses;
  for (const std::uint32_t region : {0U, 1U, 2U}) {
    participants.push_back(std::make_unique<Participant>(testing::settings_for(own_domain())));
    buses.push_back(std::make_unique<ControlBus>(*participants.back(), node_of(region, 3)));
  }
  ControlBus& newcomer = *buses[2];
  buses[0]->publish_status(status_of(0));
  ASSERT_TRUE(holds_in_time([&] { return newcomer.statuses().contains(RegionId{0}); }));
  messages::RunCommand restore;
  restore.kind = messages::RunCommandKind::kRestore;
  restore.run = 11;
  restore.region = RegionId{1};
  buses[1]->send(restore);
  buses[1]->send(command_of(messages::RunCommandKind::kPause));  // of the world that all go back to
  std::vector<messages::RunCommand> taken;
  EXPECT_FALSE(take_any(newcomer, taken, 500ms)) << "region 1 has not said that it is one";
  buses[1]->publish_status(status_of(1));
  ASSERT_TRUE(take_any(newcomer, taken, 2s));
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[0].kind, messages::RunCommandKind::kRestore);
  EXPECT_EQ(taken[1].kind, messages::RunCommandKind::kPause);
  EXPECT_THAT(participants[2]->take_said(), IsEmpty());
}

TEST_F(AStranger, BringsNoMeshUnderAnotherOnesName) {
  CommandClientEndpoint client(stranger_);
  MeshReader reader(zero_.participant);
  const core::TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}};
  const std::uint64_t hash = core::content_hash(mesh);
  client.bring(5, mesh);
  client.bring(hash, mesh);
  ASSERT_TRUE(holds_in_time([&] { return reader.mesh(hash) != nullptr; }));
  EXPECT_EQ(reader.mesh(5), nullptr);
  EXPECT_EQ(reader.refused(), 1U);
  EXPECT_EQ(zero_.participant.refused_of_strangers(), 1U);
  EXPECT_THAT(said(), HasSubstr("shape: a mesh that is not the one that it is called"));
}

TEST_F(AStranger, DoesNotKillByItsWord) {
  messages::RunCommand lost = command_of(messages::RunCommandKind::kLost);
  lost.process = 101;
  zero_bus_.receive_death(lost);
  EXPECT_FALSE(zero_bus_.statuses().at(RegionId{1}).lost) << "its process is there";
  lost.is_of_itself = true;
  zero_bus_.receive_death(lost);
  EXPECT_TRUE(zero_bus_.statuses().at(RegionId{1}).lost);
}

/// A node that waits in the middle of a step hears of deaths, and executes other commands after it.
TEST_F(AStranger, IsHeardOfDeathsBeforeOtherCommandsAreTaken) {
  using Kind = messages::RunCommandKind;
  ASSERT_TRUE(shows_a_process_that_is_gone());
  for (const Kind kind : {Kind::kPause, Kind::kLost, Kind::kResume}) {
    messages::RunCommand command = command_of(kind);
    command.process = 101;
    one_bus_.send(command);
  }
  ASSERT_TRUE(holds_in_time([&] {
    zero_bus_.hear_of_deaths();
    return zero_bus_.statuses().at(RegionId{1}).lost;
  }));
  std::vector<Kind> taken;
  ASSERT_TRUE(holds_in_time([&] {
    for (const messages::RunCommand& one : zero_bus_.take_commands()) taken.push_back(one.kind);
    return taken.size() == 2;
  }));
  EXPECT_THAT(taken, ElementsAre(Kind::kPause, Kind::kResume));
}

TEST_F(AStranger, IsBelievedOfADeathOnceTheProcessIsGone) {
  ASSERT_TRUE(shows_a_process_that_is_gone());
  messages::RunCommand lost = command_of(messages::RunCommandKind::kLost);
  lost.process = 101;
  zero_bus_.receive_death(lost);
  EXPECT_TRUE(zero_bus_.statuses().at(RegionId{1}).lost);
}

/// Reliable, and takes nothing: after the first sample it acknowledges no more.
void listen_and_never_read(Participant& participant, const char* partition) {
  eprosima::fastdds::dds::SubscriberQos where;
  where.partition().push_back(partition);
  auto* const subscriber = participant.domain().participant().create_subscriber(where);
  auto qos = participant.domain().profiles().reader(*subscriber, "aura_reader");
  qos.resource_limits().max_samples = qos.resource_limits().max_samples_per_instance = 1;
  qos.resource_limits().max_instances = qos.resource_limits().allocated_samples = 1;
  ASSERT_NE(subscriber->create_datareader(&participant.domain().topic(TopicId::kAura), qos), nullptr);
}

/// It is 10 s until nobody expects it to become a node.
TEST_F(AStranger, WhoDoesNotReadIsNotWaitedFor) {
  Writer writer(one_.participant.domain(), {TopicId::kAura, {"region/1/not/read"}, {}, {}}, wakeup_);
  listen_and_never_read(stranger_, "region/1/not/read");
  ASSERT_TRUE(holds_in_time([&] { return one_bus_.statuses().size() == 2 && writer.reader_count() == 1; }));
  wire::AuraBatch sample;
  for (int i = 0; i < 100; ++i) ASSERT_NE(writer.write(&sample), WriteResult::kFailed);
  EXPECT_FALSE(writer.all_acknowledged());
  EXPECT_TRUE(holds_in_time([&] { return writer.all_acknowledged(); }));
  const auto said = one_.participant.take_said();
  EXPECT_THAT(said, Contains(HasSubstr("reads what nodes say to each other, and is none")));
}

/// The profiles, with a history of 64 instead of 4096: then it has the room that the parts of one message need.
Settings with_short_histories() {
  std::ifstream in(std::filesystem::path(AURASIM_SOURCE_DIR) / "qos" / "aurasim.xml");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t at = 0; (at = text.find("<depth>4096</depth>", at)) != std::string::npos;)
    text.replace(at, 19, "<depth>64</depth>");
  // A process has one profile of a name: these have names of their own.
  const std::string stem = "short" + std::to_string(::getpid());
  text = std::regex_replace(text, std::regex("profile_name=\"(aurasim_)?"), "profile_name=\"" + stem + "_");
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / (stem + ".xml");
  std::ofstream(file) << text;
  Settings settings = testing::settings_for(own_domain());
  settings.profiles = file;
  return settings;
}

/// Its last samples wait for it, and nobody else does.
TEST(ADeafReader, HoldsNobodyUp) {
  const Settings settings = with_short_histories();
  Participant stranger(
      settings);  // goes last: Fast DDS 2.9.1 can lock up when a reader leaves that is being sent repeats
  Peer zero(settings, 0, {1});
  Peer one(settings, 1, {0});
  listen_and_never_read(stranger, "region/1");
  ASSERT_TRUE(holds_in_time([&] { return zero.transport.all_matched() && one.transport.all_matched(); }));
  std::this_thread::sleep_for(500ms);  // the deaf one, too
  constexpr core::Step kSteps = 2500;  // more than that room
  for (core::Step step = 0; step < kSteps; ++step) {
    one.send_batch(step, 1);
    ASSERT_TRUE(take_until(zero, [&] { return std::ssize(zero.inbox.auras) == step + 1; })) << step;
  }
  EXPECT_EQ(one.transport.counters().aura.send_failed, 0U);
  EXPECT_THAT(one.participant.take_said(), Contains(HasSubstr("a reader of topic aura has acknowledged none of")));
  std::filesystem::remove(settings.profiles);
}

}  // namespace
}  // namespace aurasim::dds
