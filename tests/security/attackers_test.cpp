// Who has no keys, wrong keys, or keys for something else, against the node of region 2: each is refused, and named.
#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "dds/command_bus.h"
#include "dds/control.h"
#include "dds/endpoints.h"
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
  explicit Node(const KeyFiles& keys) {
    Settings settings = settings_for(keys);
    settings.report_refusal = [this](const std::string& text) {
      const std::lock_guard lock(mutex_);
      refusals_.push_back(text);
    };
    domain.emplace(settings);
    commands.emplace(*domain, on(TopicId::kCommand), wakeup);
    run_control.emplace(*domain, on(TopicId::kRunControl), wakeup);
    auras.emplace(*domain, on(TopicId::kAura), wakeup);
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
  std::optional<Reader> commands, run_control, auras;
  std::optional<Writer> hand_offs;
};

/// Tries everything.
class Peer {
 public:
  explicit Peer(const std::optional<KeyFiles>& keys) : domain(settings_for(keys)) {}

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
