// Who has no keys, wrong keys, or keys for something else, against the node of region 2: each is refused, and named.
#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "dds/command_bus.h"
#include "dds/control.h"
#include "dds/endpoints.h"
#include "dds/hub.h"
#include "dds/introductions.h"
#include "forged_permissions.h"
#include "own_domain.h"
#include "scratch_store.h"

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;
using security::KeyFiles;
using security::Role;
using security::ScratchStore;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::days kValid{10};
constexpr auto kGenerous = 30s;
/// So long an attacker is given once others have got through; they are through after 0.1 s, now and then after 1 s.
constexpr auto kLongEnough = 1500ms;

Settings settings_for(const std::optional<KeyFiles>& keys) {
  Settings settings;
  settings.domain = test::own_domain();
  settings.profiles = AURASIM_SOURCE_DIR "/qos/aurasim.xml";
  settings.interfaces = {"127.0.0.1"};
  settings.keys = keys;
  return settings;
}

template <class Condition>
bool wait_until(Condition&& condition, Clock::duration time_out = kGenerous) {
  const auto deadline = Clock::now() + time_out;
  while (!condition()) {
    if (Clock::now() > deadline) return false;
    std::this_thread::sleep_for(5ms);
  }
  return true;
}

/// What a node has, as far as attackers ask for it.
class Node {
 public:
  explicit Node(const KeyFiles& keys) : Node(settings_for(keys)) {}
  explicit Node(Settings settings) {
    settings.report_refusal = [this](const std::string& text) {
      const std::lock_guard lock(mutex_);
      refusals_.push_back(text);
    };
    domain.emplace(settings);
    commands.emplace(*domain, on(TopicId::kCommand), wakeup);
    run_control.emplace(*domain, on(TopicId::kRunControl), wakeup);
    auras.emplace(*domain, on(TopicId::kAura), wakeup);
    statuses.emplace(*domain, on(TopicId::kNodeStatus), wakeup);
    hand_offs.emplace(*domain, EndpointSpec{TopicId::kMigration, {"region/2/to/1"}, {}, {}}, wakeup);
  }

  std::vector<std::string> refusals() const {
    const std::lock_guard lock(mutex_);
    return refusals_;
  }
  bool has_refused(const std::string& who, const std::string& why) const {
    return std::ranges::any_of(refusals(), [&](const std::string& text) {
      return text.find(who) != std::string::npos && text.find(why) != std::string::npos;
    });
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> refusals_;

 public:
  Wakeup wakeup;
  std::optional<Domain> domain;
  std::optional<Reader> commands, run_control, auras, statuses;
  std::optional<Writer> hand_offs;
};

/// Tries everything.
class Peer {
 public:
  explicit Peer(const std::optional<KeyFiles>& keys) : Peer(settings_for(keys)) {}
  explicit Peer(const Settings& settings) : domain(settings) {}

  Writer& says(TopicId topic, const std::string& partition) {
    writers_.push_back(std::make_unique<Writer>(domain, EndpointSpec{topic, {partition}, {}, {}}, wakeup));
    return *writers_.back();
  }
  Reader& reads(TopicId topic, const std::string& partition) {
    readers_.push_back(std::make_unique<Reader>(domain, EndpointSpec{topic, {partition}, {}, {}}, wakeup));
    return *readers_.back();
  }

  Wakeup wakeup;
  Domain domain;

 private:
  std::vector<std::unique_ptr<Writer>> writers_;
  std::vector<std::unique_ptr<Reader>> readers_;
};

class Attackers : public ::testing::Test {
 protected:
  Attackers() {
    for (std::uint32_t r = 1; r < 3; ++r) store().add(security::member_of_region(r), kValid);
    store().add({"desk", Role::kOperator}, kValid);
    store().add({"hall", Role::kViewer}, kValid);
  }

  security::KeyStore& store() { return scratch_.store; }
  KeyFiles keys_of(const std::string& name) { return store().files_of(name); }
  std::unique_ptr<Peer> peer_without_scruples(const std::string& name) {
    const security::ForgedPermissions forged(*store().find(name));
    return std::make_unique<Peer>(keys_of(name));
  }
  /// As long as an attacker would have needed, and longer: whoever may is through.
  void expect_that_the_honest_get_through(Node& node) {
    Peer operator_(keys_of("desk"));
    operator_.says(TopicId::kCommand, "world");
    Peer neighbour(keys_of("region-1"));
    neighbour.reads(TopicId::kMigration, "region/2/to/1");
    EXPECT_TRUE(
        wait_until([&] { return node.commands->watch().any_matched() && node.hand_offs->reader_count() == 1; }));
    std::this_thread::sleep_for(kLongEnough);
    EXPECT_EQ(node.commands->watch().writers().size(), 1U) << "nobody but the operator";
    EXPECT_EQ(node.hand_offs->reader_count(), 1U) << "nobody but region 1";
  }

  ScratchStore scratch_;
};

TEST(EveryTopic, HasSomebodyWhoMaySayItAndARecorderWhoReadsIt) {
  for (const topics::Topic& row : topics::all()) {
    const std::string topic = row.name;
    const auto says = [&](Role role) {
      const auto grants = security::grants_of(role, 2);
      return std::ranges::any_of(grants.publishes, [&](const security::Grant& grant) { return grant.topic == topic; });
    };
    EXPECT_TRUE(says(Role::kRegion) || says(Role::kOperator)) << topic;
    for (const char* partition : {"world", "region/*", "*"}) {
      EXPECT_TRUE(security::is_granted(security::grants_of(Role::kRecorder).subscribes, topic, partition)) << topic;
    }
  }
}

TEST_F(Attackers, WithoutKeysAreRefused) {
  Node node(keys_of("region-2"));
  Peer stranger(std::nullopt);
  Writer& command = stranger.says(TopicId::kCommand, "world");
  Reader& hand_offs = stranger.reads(TopicId::kMigration, "region/2/to/1");
  expect_that_the_honest_get_through(node);
  EXPECT_EQ(command.reader_count(), 0U);
  EXPECT_FALSE(hand_offs.watch().any_matched());
  EXPECT_TRUE(node.has_refused("without keys", "refused")) << ::testing::PrintToString(node.refusals());
}

TEST_F(Attackers, WithAnAuthorityOfTheirOwnAreRefused) {
  ScratchStore own;
  own.store.add({"desk", Role::kOperator}, kValid);
  Node node(keys_of("region-2"));
  Peer impostor(own.store.files_of("desk"));
  Writer& command = impostor.says(TopicId::kCommand, "world");
  expect_that_the_honest_get_through(node);
  EXPECT_EQ(command.reader_count(), 0U);
  EXPECT_TRUE(node.has_refused("CN=desk", "unable to get local issuer certificate"))
      << ::testing::PrintToString(node.refusals());
}

TEST_F(Attackers, WhoseCertificateHasEndedAreRefused) {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  store().add({"late", Role::kOperator}, security::Validity{now - 10s, now + 3s});
  Peer late(keys_of("late"));  // while it is good
  Writer& command = late.says(TopicId::kCommand, "world");
  std::this_thread::sleep_until(now + 4s);
  Node node(keys_of("region-2"));
  expect_that_the_honest_get_through(node);
  EXPECT_EQ(command.reader_count(), 0U);
  EXPECT_TRUE(wait_until([&] { return node.has_refused("CN=late", "expired"); }))
      << ::testing::PrintToString(node.refusals());
}

TEST_F(Attackers, WhoAreRevokedAreRefused) {
  store().add({"gone", Role::kOperator}, kValid);
  KeyFiles keys = keys_of("gone");
  keys.revocations = scratch_.write("old_crl.pem", security::text_of(keys.revocations));
  store().revoke("gone");
  Node node(keys_of("region-2"));
  Peer gone(keys);
  Writer& command = gone.says(TopicId::kCommand, "world");
  expect_that_the_honest_get_through(node);
  EXPECT_EQ(command.reader_count(), 0U);
  EXPECT_TRUE(node.has_refused("CN=gone", "revoked")) << ::testing::PrintToString(node.refusals());
}

TEST_F(Attackers, WithTheKeysOfAViewerSayNothingAndReadNoHandOffs) {
  Node node(keys_of("region-2"));
  const std::unique_ptr<Peer> viewer = peer_without_scruples("hall");
  Writer& command = viewer->says(TopicId::kCommand, "world");
  Writer& control = viewer->says(TopicId::kRunControl, "world");
  Reader& hand_offs = viewer->reads(TopicId::kMigration, "region/2/to/1");
  expect_that_the_honest_get_through(node);
  EXPECT_EQ(command.reader_count(), 0U);
  EXPECT_EQ(control.reader_count(), 0U);
  EXPECT_FALSE(hand_offs.watch().any_matched());
  EXPECT_TRUE(node.has_refused("CN=hall", "command topic not found in allow rule"))
      << ::testing::PrintToString(node.refusals());
  EXPECT_TRUE(node.has_refused("CN=hall", "migration topic not found in allow rule"))
      << ::testing::PrintToString(node.refusals());
}

TEST_F(Attackers, OfRegion1DoNotSpeakAsRegion2) {
  Node node(keys_of("region-2"));
  const std::unique_ptr<Peer> neighbour = peer_without_scruples("region-1");
  Writer& as_itself = neighbour->says(TopicId::kAura, "region/1");
  Writer& as_another = neighbour->says(TopicId::kAura, "region/2");
  EXPECT_TRUE(wait_until([&] { return as_itself.reader_count() == 1; }));
  std::this_thread::sleep_for(kLongEnough);
  EXPECT_EQ(as_another.reader_count(), 0U);
  EXPECT_EQ(node.auras->watch().writers().size(), 1U);
  EXPECT_TRUE(node.has_refused("CN=region-1", "region/2 partition not found in rule"))
      << ::testing::PrintToString(node.refusals());
}

/// A process of no key at all that says that it is a hub, so that others look for one.
Settings calls_itself_a_hub() {
  Settings settings = settings_for({});
  settings.discovery = config::Discovery::kNeighbours;
  settings.introductions = std::make_shared<Introductions>();
  return settings;
}

/// A status of `region`, of a writer that passes it on for another one.
void pass_on_status(Writer& writer, std::uint32_t region) {
  auto status = std::make_shared<wire::NodeStatus>();
  status->source(region);
  PassedSample passed;
  passed.sample = status;
  passed.writer.guidPrefix.value[0] = 77;
  passed.number = 1;
  ASSERT_NE(writer.pass_on(passed), WriteResult::kFailed);
}

struct Heard {
  std::uint32_t region = 0;
  Origin origin;
};

/// The next status that the node hears; nothing: none has come.
std::optional<Heard> take_status(Node& node, Clock::duration time_out = kGenerous) {
  Heard heard;
  wire::NodeStatus status;
  if (!wait_until([&] { return node.statuses->take(&status, &heard.origin); }, time_out)) return std::nullopt;
  heard.region = status.source();
  return heard;
}

TEST_F(Attackers, OfNoRoleButAHubsSpeakAsAHub) {
  store().add({"spare", Role::kSpare}, kValid);
  store().add({"tape", Role::kRecorder}, kValid);
  store().add({"hub-1", Role::kHub}, kValid);
  Node node(keys_of("region-2"));
  Peer stranger(calls_itself_a_hub());
  std::vector<std::unique_ptr<Peer>> attackers;
  std::vector<Writer*> writers;
  for (const char* name : {"region-1", "spare", "desk", "hall", "tape"}) {
    attackers.push_back(peer_without_scruples(name));
    for (const char* partition : {"from_hub", "from_*", "*"}) {
      writers.push_back(&attackers.back()->says(TopicId::kNodeStatus, partition));
    }
  }
  Peer hub(keys_of("hub-1"));
  Writer& of_hub = hub.says(TopicId::kNodeStatus, "from_hub");
  ASSERT_TRUE(wait_until([&] {
    wire::NodeStatus status;
    node.statuses->take(&status);  // looks for a hub
    return of_hub.reader_count() > 0 && node.domain->speakers().has_hub();
  }));
  std::this_thread::sleep_for(kLongEnough);
  for (const char* name : {"CN=region-1", "CN=spare"}) {
    EXPECT_TRUE(wait_until([&] { return node.has_refused(name, "from_hub partition not found in rule"); })) << name;
  }
  for (const char* name : {"CN=desk", "CN=hall"}) {
    EXPECT_TRUE(wait_until([&] { return node.has_refused(name, "node_status topic not found in allow rule"); }))
        << name;
  }
  for (const Writer* writer : writers) EXPECT_EQ(writer->reader_count(), 0U);
  pass_on_status(of_hub, 5);
  const auto heard = take_status(node);
  ASSERT_TRUE(heard.has_value());
  EXPECT_TRUE(heard->origin.by_hub);
  EXPECT_EQ(heard->origin.writer.guidPrefix.value[0], 77);
}

/// Fast DDS keeps the match that the former partition has made.
TEST_F(Attackers, WhoMoveToThePartitionOfAHubOrOfAnotherRegionSpeakForThemselves) {
  Node node(keys_of("region-2"));
  Peer stranger(calls_itself_a_hub());
  const std::unique_ptr<Peer> neighbour = peer_without_scruples("region-1");
  for (const char* to : {"from_hub", "region/0"}) {
    SCOPED_TRACE(to);
    eprosima::fastdds::dds::PublisherQos qos;
    qos.partition().push_back("region/1");
    auto* const publisher = neighbour->domain.participant().create_publisher(qos);
    auto* const writer =
        publisher->create_datawriter(&neighbour->domain.topic(TopicId::kNodeStatus),
                                     neighbour->domain.profiles().writer(*publisher, "node_status_writer"));
    ASSERT_NE(writer, nullptr);
    wire::NodeStatus status;
    ASSERT_TRUE(wait_until([&] {
      node.statuses->take(&status);
      return node.statuses->watch().any_matched(writer->guid().guidPrefix);
    }));
    qos.partition().clear();
    qos.partition().push_back(to);
    publisher->set_qos(qos);
    std::this_thread::sleep_for(kLongEnough);  // until everybody knows
    eprosima::fastrtps::rtps::WriteParams params;
    params.related_sample_identity().writer_guid().guidPrefix.value[0] = 77;
    params.related_sample_identity().sequence_number({0, 1});
    status.source(0);
    writer->write(&status, params);
    const auto heard = take_status(node, kLongEnough);
    if (heard) {
      EXPECT_FALSE(heard->origin.by_hub);
      EXPECT_EQ(heard->origin.writer, writer->guid());
      EXPECT_FALSE(node.domain->speakers().is_at_home(heard->origin.writer, core::RegionId{0}));
    }
    RecordProperty(to, heard ? "heard" : "not heard");
  }
}

TEST_F(Attackers, OfRegion1SayNothingOfRegion2ThroughAHub) {
  store().add({"hub-1", Role::kHub}, kValid);
  const auto by_hub = [&](const char* name) {
    Settings settings = settings_for(keys_of(name));
    settings.discovery = config::Discovery::kNeighbours;
    return settings;
  };
  Hub hub(by_hub("hub-1"));
  std::jthread turning([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) hub.turn(20ms);
  });
  Node node(by_hub("region-2"));
  Peer neighbour(by_hub("region-1"));
  Writer& status = neighbour.says(TopicId::kNodeStatus, "region/1");  // that is hub/region/1
  ASSERT_TRUE(wait_until([&] { return status.reader_count() == 1 && node.domain->has_way_to_all(); }));
  wire::NodeStatus of_another, own;
  of_another.source(2);
  own.source(1);
  status.write(&of_another);
  status.write(&own);
  const auto heard = take_status(node);
  ASSERT_TRUE(heard.has_value());
  EXPECT_EQ(heard->region, 1U);
  EXPECT_TRUE(heard->origin.by_hub);
  EXPECT_EQ(heard->origin.writer, status.guid());
  EXPECT_FALSE(take_status(node, 300ms).has_value());
  turning.request_stop();
  turning.join();
  EXPECT_EQ(hub.counts().refused, 1U);
  EXPECT_EQ(hub.counts().passed, 1U);
}

TEST_F(Attackers, WhoAreOperatorsAreGivenNoMoreThanAnybodyElse) {
  Participant node(settings_for(keys_of("region-2"))), desk(settings_for(keys_of("desk")));
  CommandServerEndpoint server(node, core::RegionId{2}, 7);
  CommandClientEndpoint client(desk);
  ControlBus control(node, {.region_count = 3}), steering(desk, {.region_count = 3});
  ASSERT_TRUE(wait_until([&] { return client.listeners() == 1 && steering.listeners() == 1; }));
  std::size_t commands = 0, words = 0, sent = 0;
  std::string said;
  const auto both_are_named = [&said] {
    return said.find("command: 500 a second") != std::string::npos &&
           said.find("run_control: 500 a second") != std::string::npos;
  };
  const auto begin = Clock::now();
  while (!both_are_named() && Clock::now() < begin + kGenerous) {
    for (int i = 0; i < 50; ++i, ++sent) {
      core::Command command;
      command.ask = core::SetRate{0.5};
      client.send(command, 0);
      messages::RunCommand pause;
      pause.kind = messages::RunCommandKind::kPause;
      steering.send(pause);
      commands += server.take().size();
      words += control.take_commands().size();
    }
    for (const std::string& text : node.take_said()) said += text + "\n";
  }
  const double given = 1000 + 500 * std::chrono::duration<double>(Clock::now() - begin).count();
  EXPECT_TRUE(both_are_named()) << said << sent << " sent";
  EXPECT_NE(said.find("CN=desk"), std::string::npos) << said;
  EXPECT_LE(static_cast<double>(commands), given);
  EXPECT_LE(static_cast<double>(words), given);
  EXPECT_GE(commands, 500U);
  EXPECT_GE(words, 500U);
  EXPECT_GT(node.refused_of_strangers(), 0U);
  EXPECT_EQ(said.find("not listened to"), std::string::npos) << said;
}

}  // namespace
}  // namespace aurasim::dds
