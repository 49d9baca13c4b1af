// Runs with dds.discovery: neighbours (docs/decisions/0052): the same bits, also when the hub dies.
#include <csignal>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

const Words kByHub = set({"dds.discovery=neighbours", "time.sync=deterministic", "time.pace=none"});
/// Six regions that listen to the next ones only.
const Words kSix = set({"regions={layout: columns, count: 6, width: 12}"});

class AHub : public SystemTest {
 protected:
  /// The hub's process; 0: there is none.
  static pid_t hub_of(const Process& launcher) {
    for (const pid_t child : children_of(launcher.pid())) {
      const Words words = command_line_of(child);
      if (words.size() > 1 && words[1] == "hub") return child;
    }
    return 0;
  }
  /// The hash of every state.
  std::string hashes(const std::string& name, const Words& more) {
    Process& run = launch(name, launch_file("demo"), more);
    expect_exit(run, 0);
    expect_all_bodies_accounted_for(report_of(name));
    return report_of(name).state_hash();
  }
};

TEST_F(AHub, BringsThoseTogetherWhoNeedEachOther) {
  const Words steps = {"--steps", "300"};
  const std::string by_hub = hashes("by_hub", steps + kByHub + kSix);
  EXPECT_GT(report_of("by_hub").count("migrations"), 50);
  const std::string central =
      hashes("central", steps + set({"regions.count=1", "time.sync=deterministic", "time.pace=none"}));
  EXPECT_EQ(first_difference(by_hub, central), "");
}

TEST_F(AHub, ServesCoupledRegionsAndTheChoiceOfTheExchange) {
  const Words steps = {"--steps", "200"};
  const std::string by_hub = hashes("by_hub", steps + kByHub + set({"exchange=auto", "exchange_limit=10"}));
  EXPECT_EQ(report_of("by_hub").entry("exchange"), "coupled");
  const std::string central =
      hashes("central", steps + set({"regions.count=1", "time.sync=deterministic", "time.pace=none"}));
  EXPECT_EQ(first_difference(by_hub, central), "");
}

TEST_F(AHub, ThatIsKilledIsStartedAgainAndTheRunGoesOn) {
  const Words in_time = set({"dds.discovery=neighbours", "time.sync=deterministic"});
  Process& run = launch("killed", launch_file("demo"), Words{"--steps", "600"} + in_time + kSix);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("killed"), 6, 120));
  const pid_t first = hub_of(run);
  ASSERT_NE(first, 0);
  ASSERT_EQ(::kill(first, SIGKILL), 0);
  ASSERT_TRUE(wait_until([&] { return hub_of(run) != 0 && hub_of(run) != first; }, kGenerous));
  expect_exit(run, 0);
  EXPECT_THAT(run.err(), ::testing::HasSubstr("the hub of the run has ended; the launcher starts it again"));
  EXPECT_THAT(run.err(), ::testing::Not(::testing::HasSubstr("died")));
  expect_all_bodies_accounted_for(report_of("killed"));
  const std::string central = hashes(
      "central", Words{"--steps", "600"} + set({"regions.count=1", "time.pace=none", "time.sync=deterministic"}));
  EXPECT_EQ(first_difference(report_of("killed").state_hash(), central), "");
}

TEST_F(AHub, ThatIsKilledWhileTheNodesMeetHoldsThemUpOnly) {
  Process& run = launch("met", launch_file("demo"), Words{"--steps", "120"} + kByHub + kSix);
  ASSERT_TRUE(wait_until([&] { return hub_of(run) != 0 && node_of(run, 5) != 0; }, kGenerous));
  ASSERT_EQ(::kill(hub_of(run), SIGKILL), 0);
  expect_exit(run, 0);
  EXPECT_EQ(report_of("met").count("steps"), 120);
  expect_all_bodies_accounted_for(report_of("met"));
}

TEST_F(AHub, LetsARegionBeTakenOverWhoseNodeDies) {
  const Words in_time = set({"dds.discovery=neighbours", "time.sync=deterministic"});
  Process& run = launch("died", launch_file("demo"), Words{"--steps", "600"} + in_time + kSix);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("died"), 6, 120));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("died"));
}

/// All go back to parts of the world that come by the hub, each as large as the datagrams of this profile allow.
TEST_F(AHub, PassesOnWhatFillsADatagram) {
  const Words in_time = set({"dds.discovery=neighbours", "time.sync=deterministic",
                             std::string("dds.profiles=") + AURASIM_SOURCE_DIR + "/qos/hosts.xml"});
  Process& run = launch("died", launch_file("demo"), Words{"--steps", "600"} + in_time + kSix);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("died"), 6, 120));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("died"));
}

TEST_F(AHub, PassesCommandsOn) {
  Process& run = launch("steered", launch_file("demo"), set({"dds.discovery=neighbours"}));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("steered"), 4, 60));
  const Words there = in_own_domain() + set({"dds.discovery=neighbours"});
  Process& ask = start(Words{"send", "pause", launch_file("demo")} + there);
  expect_exit(ask, 0);
  Process& stop = start(Words{"send", "stop", launch_file("demo")} + there);
  expect_exit(stop, 0);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("steered"));
}

/// Programs that announce themselves by multicast, as they do in other runs.
TEST_F(AHub, BringsThoseWhoKnowNothingOfItToTheNodes) {
  const Words before = Words{"echo", "node_status", launch_file("demo")} + in_own_domain();
  Process& early = start(before);
  Process& run = launch("met", launch_file("demo"), set({"dds.discovery=neighbours"}));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("met"), 4, 60));
  EXPECT_TRUE(wait_until([&] { return !early.out().empty(); }, kGenerous)) << early.err();
  Process& late = start(Words{"echo", "aura", launch_file("demo")} + in_own_domain());
  EXPECT_TRUE(wait_until([&] { return !late.out().empty(); }, kGenerous)) << late.err();
  Process& stop = start(Words{"send", "stop", launch_file("demo")} + in_own_domain());
  expect_exit(stop, 0);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("met"));
}

/// Six regions in a run with keys, which are in a folder.
class AHubWithKeys : public AHub {
 protected:
  std::string keys() const { return (folder() / "keys").string(); }
  /// Keys for all but a hub.
  void make_keys() {
    expect_exit(start({"keys", "init", keys()}), 0);
    expect_exit(start({"keys", "add-region", keys(), "0-5"}), 0);
    for (const char* role : {"operator", "viewer"}) add_key(role);
  }
  void add_key(const std::string& role) { expect_exit(start({"keys", "add", keys(), role, "--role", role}), 0); }
  Words with_keys() const { return set({"dds.security=" + keys()}); }
};

TEST_F(AHubWithKeys, LeadsToTheSameBits) {
  const Words steps = {"--steps", "300"};
  const std::string by_hub = hashes("by_hub", Words{"--secure"} + steps + kByHub + kSix);
  EXPECT_GT(report_of("by_hub").count("migrations"), 50);
  const std::string central =
      hashes("central", steps + set({"regions.count=1", "time.sync=deterministic", "time.pace=none"}));
  EXPECT_EQ(first_difference(by_hub, central), "");
}

TEST_F(AHubWithKeys, ThatIsKilledIsStartedAgainAndClientsFindTheRun) {
  make_keys();
  add_key("hub");
  const std::string demo = launch_file("demo");
  const Words its = set({"time.sync=deterministic"}) + kSix + with_keys();
  Process& run = launch("killed", demo, Words{"--steps", "900"} + set({"dds.discovery=neighbours"}) + its);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("killed"), 6, 60));
  const pid_t first = hub_of(run);
  ASSERT_NE(first, 0);
  ASSERT_EQ(::kill(first, SIGKILL), 0);
  ASSERT_TRUE(wait_until([&] { return hub_of(run) != 0 && hub_of(run) != first; }, kGenerous));
  Process& echo = start(Words{"echo", "node_status", demo, "--count", "12", "--as", "viewer"} + in_own_domain() +
                        its);  // by multicast
  expect_exit(echo, 0);
  for (const char* command : {"pause", "resume"}) {
    expect_exit(start(Words{"send", command, demo} + in_own_domain() + its), 0);
  }
  expect_exit(run, 0);
  EXPECT_THAT(run.err(), ::testing::Not(::testing::HasSubstr("died")));
  expect_all_bodies_accounted_for(report_of("killed"));
  const std::string central = hashes(
      "central", Words{"--steps", "900"} + set({"regions.count=1", "time.pace=none", "time.sync=deterministic"}));
  EXPECT_EQ(first_difference(report_of("killed").state_hash(), central), "");
}

TEST_F(AHubWithKeys, LetsARegionBeTakenOverWhoseNodeDies) {
  Process& run =
      launch("died", launch_file("demo"),
             Words{"--secure", "--steps", "600"} + set({"dds.discovery=neighbours", "time.sync=deterministic"}) + kSix);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("died"), 6, 120));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("died"));
}

TEST_F(AHubWithKeys, IsNobodyWhoHasNotItsKey) {
  make_keys();
  const std::string demo = launch_file("demo");
  const Words neighbours = set({"dds.discovery=neighbours"});
  for (const char* name : {"region-1", "operator", "viewer"}) {
    Process& hub = start(Words{"hub", demo, "--as", name} + in_own_domain() + neighbours + with_keys());
    expect_exit(hub, 2);
    EXPECT_THAT(hub.err(), ::testing::HasSubstr("allowed for this: hub"));
  }
  Process& without = launch("without", demo, neighbours + kSix + with_keys());
  expect_exit(without, 2);
  EXPECT_THAT(without.err(), ::testing::HasSubstr("hub-1 --role hub"));
}

TEST_F(AHubWithKeys, HearsNoStrangerAndStrangersHearNothing) {
  const std::string demo = launch_file("demo");
  const Words neighbours = set({"dds.discovery=neighbours"});
  Process& stranger = start(Words{"hub", demo} + in_own_domain() + neighbours);
  Process& listener = start(Words{"echo", "node_status", demo} + in_own_domain());
  Process& run = launch("run", demo, Words{"--secure", "--steps", "200"} + kByHub + kSix);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("run"));
  EXPECT_EQ(listener.out(), "");
  EXPECT_FALSE(stranger.wait(0ms)) << stranger.said();
}

TEST_F(AHubWithKeys, IsThereByDefaultWhereThereAreManyNodes) {
  Process& run = launch("many", launch_file("demo"),
                        Words{"--secure", "--steps", "20"} + set({"regions={layout: columns, count: 10, width: 8}"}));
  EXPECT_TRUE(wait_until([&] { return hub_of(run) != 0 || run.wait(0ms); }, kGenerous));
  EXPECT_NE(hub_of(run), 0);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("many"));
}

TEST_F(AHub, IsThereByDefaultWhereThereAreManyNodes) {
  Process& run = launch("many", launch_file("demo"),
                        Words{"--steps", "20"} + set({"regions={layout: columns, count: 17, width: 6}"}));
  EXPECT_TRUE(wait_until([&] { return hub_of(run) != 0 || run.wait(0ms); }, kGenerous));
  EXPECT_NE(hub_of(run), 0);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("many"));
}

TEST_F(AHub, IsAloneInItsDomain) {
  const Words words = Words{"hub", launch_file("demo")} + set({"dds.discovery=neighbours"}) + in_own_domain();
  Process& one = start(words);
  Process& other = start(words);
  Process* ended = nullptr;  // whichever came second
  ASSERT_TRUE(wait_until(
      [&] {
        for (Process* hub : {&one, &other}) {
          if (ended == nullptr && hub->wait(0ms)) ended = hub;
        }
        return ended != nullptr;
      },
      kGenerous));
  EXPECT_THAT(ended->err(), ::testing::HasSubstr("already has a hub"));
  EXPECT_FALSE((ended == &one ? other : one).wait(500ms)) << "one of them stays";
}

TEST_F(AHub, IsNamedByThoseWhoMissIt) {
  Process& top = start(Words{"top", launch_file("demo")} + in_own_domain() + set({"dds.discovery=neighbours"}));
  expect_exit(top, 1);
  EXPECT_THAT(top.err(), ::testing::HasSubstr("no hub of a run is in DDS domain"));
  Process& node = start(Words{"node", launch_file("demo"), "--region", "0", "--start-time-out", "1"} + in_own_domain() +
                        set({"dds.discovery=neighbours"}));
  expect_exit(node, 3);
  EXPECT_THAT(node.err(), ::testing::HasSubstr("no hub of DDS domain"));
}

TEST_F(AHub, IsNotThereForOtherDiscovery) {
  Process& hub = start(Words{"hub", launch_file("demo")} + in_own_domain());
  expect_exit(hub, 2);
  EXPECT_THAT(hub.err(), ::testing::HasSubstr("dds.discovery"));
}

}  // namespace
}  // namespace aurasim::system_test
