#include <cmath>

#include "config/launch_variants.h"
#include "config/presets.h"
#include "config/workspace.h"

namespace aurasim::config {
namespace {

TEST(LaunchFile, EverythingButSceneAndRegionsHasADefault) {
  const Workspace workspace;
  const Launch launch = workspace.launch(kSmallLaunch);
  EXPECT_EQ(launch.regions.size(), 2u);
  EXPECT_EQ(launch.time.step_hz, 60);
  EXPECT_EQ(launch.time.substeps, 8);
  EXPECT_EQ(launch.time.sync, core::SyncMode::kBounded);
  EXPECT_FALSE(launch.time.lookahead);
  EXPECT_EQ(launch.time.pace, Pace::kWall);
  EXPECT_EQ(launch.tolerances.speed_m_s, 32);
  EXPECT_EQ(launch.tolerances.latency_s, 0.002);
  EXPECT_EQ(launch.tolerances.frame_s, 0.015);
  EXPECT_EQ(launch.exchange, Exchange::kAuto);
  EXPECT_EQ(launch.aura.radius, core::AuraKind::kSwept);
  EXPECT_EQ(launch.uncertainty(), 0.5);
  EXPECT_EQ(launch.physics.solver, "soft_step");
  EXPECT_EQ(launch.physics.iterations, 10);
  EXPECT_EQ(launch.dds.domain, 0);
  EXPECT_EQ(launch.dds.discovery, Discovery::kAuto);
  EXPECT_THAT(launch.dds.interfaces, testing::ElementsAre("127.0.0.1"));
  EXPECT_TRUE(launch.dds.profiles.is_absolute());
  EXPECT_EQ(launch.observe.tick_hz, 20);
}

TEST(LaunchFile, ExchangeAutoIsSettledWhereOnlyOneOfTheTwoIsPossibleOrMakesSense) {
  const Workspace workspace;
  const std::string automatic = std::string(kSmallLaunch) + "exchange: auto\n";
  const Launch open = workspace.launch(automatic);
  EXPECT_EQ(open.exchange, Exchange::kAuto);
  EXPECT_FALSE(open.is_coupled());
  EXPECT_EQ(open.why_exchange, "");
  EXPECT_EQ(workspace.launch(automatic, {"regions.count=1"}).exchange, Exchange::kAura);
  EXPECT_EQ(workspace.launch(automatic, {"regions.count=36"}).exchange, Exchange::kAuto);
  EXPECT_EQ(workspace.launch(automatic, {"regions.count=37"}).exchange, Exchange::kAura) << "each step waits for all";
  EXPECT_TRUE(workspace.launch(automatic, {"regions.count=37", "exchange=coupled"}).is_coupled());
  const std::vector<std::vector<std::string>> cases = {
      {"physics.solver=sequential_impulse"},
      {"time.sync=free_running"},
      {"regions={layout: columns, count: 3, width: 40}", "physics.block=64"}};
  for (const std::vector<std::string>& impossible : cases) {
    const Launch launch = workspace.launch(automatic, impossible);
    EXPECT_EQ(launch.exchange, Exchange::kAura) << impossible.front();
    EXPECT_NE(launch.why_exchange, "") << impossible.front();
    std::vector<std::string> coupled = impossible;
    coupled.emplace_back("exchange=coupled");
    EXPECT_THROW(workspace.launch(automatic, coupled), BadConfig) << impossible.front();
  }
  const Launch narrow =
      workspace.launch(automatic, {"regions={layout: columns, count: 8, width: 2}", "physics.block=1"});
  EXPECT_TRUE(narrow.is_coupled()) << "auras need wider regions";
  EXPECT_THAT(narrow.why_exchange, testing::HasSubstr("the narrowest region is 2 m wide"));
}

TEST(LaunchFile, ExchangeLimitIsGivenOrLeavesTheExchangesOfAStepAQuarterOfItsTime) {
  const Workspace workspace;
  EXPECT_NEAR(workspace.launch(kSmallLaunch, {"time.substeps=8"}).exchange_limit_s(), 1.0 / 60 / 2 / 17, 1e-12);
  EXPECT_NEAR(workspace.launch(kSmallLaunch, {"time.substeps=4"}).exchange_limit_s(), 1.0 / 60 / 2 / 9, 1e-12);
  EXPECT_EQ(workspace.launch(kSmallLaunch, {"exchange_limit=0.002"}).exchange_limit_s(), 0.002);
}

TEST(LaunchFile, WhatTheNodesHaveChosenStaysChosenInOtherRegions) {
  const Workspace workspace;
  const Launch open = workspace.launch(std::string(kSmallLaunch) + "exchange: auto\n");
  const std::vector<core::Rectangle> halves = {{-INFINITY, -INFINITY, 8, INFINITY}, {8, -INFINITY, INFINITY, INFINITY}};
  for (const Exchange chosen : {Exchange::kAura, Exchange::kCoupled}) {
    const Launch settled = with_exchange(open, chosen);
    EXPECT_EQ(settled.exchange, chosen);
    EXPECT_EQ(settled.is_coupled(), chosen == Exchange::kCoupled);
    EXPECT_EQ(settled.world_identity(), open.world_identity());
    EXPECT_EQ(with_regions(settled, halves).exchange, chosen);
  }
  const Launch narrow = workspace.launch(std::string(kSmallLaunch) + "exchange: auto\n",
                                         {"regions={layout: columns, count: 8, width: 2}", "physics.block=1"});
  EXPECT_EQ(with_regions(narrow, halves).exchange, Exchange::kCoupled) << "though wide regions could have auras";
}

TEST(LaunchFile, Ros2IsSpokenWhereItIsSaid) {
  const Workspace workspace;
  const std::string start = kSmallLaunch;
  EXPECT_FALSE(workspace.launch(start).ros2.on);
  EXPECT_FALSE(workspace.launch(start + "ros2: off\n").ros2.on);
  EXPECT_TRUE(workspace.launch(start + "ros2: on\n").ros2.on);
  EXPECT_TRUE(workspace.launch(start + "ros2: {}\n").ros2.on);
  EXPECT_TRUE(workspace.launch(start, {"ros2=on"}).ros2.on);
  const Ros2 ros2 = workspace.launch(start + "ros2: {domain: 42, tf_hz: 50, frame: map}\n").ros2;
  EXPECT_TRUE(ros2.on);
  EXPECT_EQ(ros2.domain, 42);
  EXPECT_EQ(ros2.tf_hz, 50);
  EXPECT_EQ(ros2.frame, "map");
  EXPECT_THAT(ros2.cmd_vel, testing::IsEmpty());
}

TEST(LaunchFile, Ros2IsNotSpokenBesideKeys) {
  const Workspace workspace;
  workspace.write("keys/identity_ca.pem", "");
  const std::string keys = std::string(kSmallLaunch) + "dds: {security: keys}\n";
  EXPECT_FALSE(workspace.launch(keys + "ros2: off\n").ros2.on);
  EXPECT_THROW(workspace.launch(keys + "ros2: on\n"), BadConfig);
}

TEST(LaunchFile, FilesOfTlsAreBesideItAndNotLookedForHere) {
  const Workspace workspace;
  EXPECT_FALSE(workspace.launch(kSmallLaunch).overseer.tls);
  const Launch launch = workspace.launch(std::string(kSmallLaunch) +
                                         "overseer: {port: 8443, tls: {certificate: tls/c.pem, key: ../k.pem}}\n");
  EXPECT_EQ(launch.overseer.port, 8443);
  ASSERT_TRUE(launch.overseer.tls);
  EXPECT_EQ(launch.overseer.tls->certificate, launch.file.parent_path() / "tls/c.pem");
  EXPECT_EQ(launch.overseer.tls->key, launch.file.parent_path().parent_path() / "k.pem");
}

TEST(LaunchFile, SaysWhatBecomesOfPrograms) {
  const Workspace workspace;
  const core::ControlRules usual = workspace.launch(kSmallLaunch).control_rules();
  EXPECT_EQ(usual.late, core::LateSetpoint::kNextState);
  EXPECT_EQ(usual.on_silence, core::OnSilence::kHold);
  EXPECT_EQ(usual.silence, 30);
  workspace.write("setpoints.csv", "region,step,what,id,x0,x1,x2,x3,x4,x5,x6,x7\n");
  const Launch launch = workspace.launch(
      std::string(kSmallLaunch) + "control: {late: drop, silence: 2, on_silence: last, replay: setpoints.csv}\n");
  EXPECT_EQ(launch.control_rules().late, core::LateSetpoint::kDropped);
  EXPECT_EQ(launch.control_rules().on_silence, core::OnSilence::kLast);
  EXPECT_EQ(launch.control_rules().silence, 120);
  EXPECT_EQ(launch.control.replay, launch.file.parent_path() / "setpoints.csv");
}

TEST(LaunchFile, TheDefaultsAreThePresetBalanced) {
  const Launch launch = Workspace().launch(kSmallLaunch);
  EXPECT_EQ(launch.physics.solver, preset_named("balanced").solver);
  EXPECT_EQ(launch.time.substeps, preset_named("balanced").substeps);
}

TEST(LaunchFile, WhatIsAutoFollowsFromTheSolver) {
  const Workspace workspace;
  const std::string start = kSmallLaunch;
  EXPECT_TRUE(workspace.launch(start).physics.is_continuous());
  EXPECT_TRUE(workspace.launch(start + "physics: {continuous: auto}\n").physics.is_continuous());
  EXPECT_FALSE(workspace.launch(start + "physics: {continuous: false}\n").physics.is_continuous());
  EXPECT_FALSE(workspace.launch(start + "physics: {solver: sequential_impulse}\n").physics.is_continuous());
  EXPECT_EQ(workspace.launch(start).physics.threads, std::nullopt);
  EXPECT_EQ(workspace.launch(start + "physics: {threads: 3}\n").physics.threads, 3);
  EXPECT_EQ(workspace.launch(start + "physics: {threads: auto}\n").physics.threads, std::nullopt);
  EXPECT_EQ(workspace.launch(start).block_m(), 16);
  EXPECT_EQ(workspace.launch(start + "physics: {block: auto}\n").block_m(), 16);
  EXPECT_EQ(workspace.launch(start + "physics: {block: 5.5}\n").block_m(), 5.5);
}

TEST(LaunchFile, APresetSetsThePhysicsAndWhatStandsBesideItGoesBefore) {
  const Workspace workspace;
  const std::string start = kSmallLaunch;
  const Launch exact = workspace.launch(start + "physics: {preset: exact}\n");
  EXPECT_EQ(exact.physics.solver, preset_named("exact").solver);
  EXPECT_EQ(exact.physics.iterations, preset_named("exact").iterations);
  EXPECT_EQ(exact.physics.friction_directions, preset_named("exact").friction_directions);
  EXPECT_EQ(exact.time.substeps, preset_named("exact").substeps);
  const Launch changed =
      workspace.launch(start + "time: {substeps: 3}\nphysics: {iterations: 7, preset: exact, solver: soft_step}\n");
  EXPECT_EQ(changed.time.substeps, 3);
  EXPECT_EQ(changed.physics.iterations, 7);
  EXPECT_EQ(changed.physics.solver, "soft_step");
}

TEST(LaunchFile, EveryKeyIsRead) {
  const Workspace workspace;
  workspace.write("qos.xml", "<dds/>");
  workspace.write("keys/identity_ca.pem", "");
  const Launch launch = workspace.launch(R"(scene: scene.yaml
regions: {layout: grid, rows: 1, columns: 3, cell: [50, 60], neighbour_distance: 70}
time: {step_hz: 120, substeps: 2, sync: deterministic, lookahead: 3, pace: none}
tolerances: {speed: 20, latency: 0.001, frame: 0.005}
aura: {radius: tight, uncertainty: 1}
physics: {solver: sequential_impulse, iterations: 30, friction_directions: 2, erp: 0.1, continuous: true}
dds: {domain: 7, profiles: qos.xml, discovery: peers, interfaces: [10.0.0.1, 127.0.0.1], peers: ["10.0.0.2:7400"],
      security: keys}
observe: {tick_hz: 30}
)");
  EXPECT_EQ(launch.regions.size(), 3u);
  EXPECT_EQ(launch.neighbour_distance_m, 70);
  EXPECT_EQ(launch.time.step_hz, 120);
  EXPECT_EQ(launch.time.substeps, 2);
  EXPECT_EQ(launch.time.sync, core::SyncMode::kDeterministic);
  EXPECT_EQ(launch.time.pace, Pace::kNone);
  EXPECT_EQ(launch.lookahead(), 3);
  EXPECT_EQ(launch.tolerances.speed_m_s, 20);
  EXPECT_EQ(launch.aura.radius, core::AuraKind::kTight);
  EXPECT_EQ(launch.uncertainty(), 1);
  EXPECT_EQ(launch.physics.solver, "sequential_impulse");
  EXPECT_EQ(launch.physics.iterations, 30);
  EXPECT_EQ(launch.physics.friction_directions, 2);
  EXPECT_EQ(launch.physics.contact_erp, 0.1);
  EXPECT_TRUE(launch.physics.is_continuous());
  EXPECT_EQ(launch.dds.domain, 7);
  EXPECT_EQ(launch.dds.profiles, workspace.folder() / "qos.xml");
  EXPECT_EQ(launch.dds.security, workspace.folder() / "keys");
  EXPECT_EQ(launch.dds.discovery, Discovery::kPeers);
  EXPECT_THAT(launch.dds.interfaces, testing::ElementsAre("10.0.0.1", "127.0.0.1"));
  EXPECT_THAT(launch.dds.peers, testing::ElementsAre("10.0.0.2:7400"));
  EXPECT_EQ(launch.observe.tick_hz, 30);
}

TEST(LaunchFile, HasNeighboursOnLoopbackOrByAHubThatIsNamed) {
  Workspace workspace;
  const auto read = [&](const std::string& dds) { return workspace.launch(kSmallLaunch + ("dds: " + dds + "\n")); };
  EXPECT_EQ(read("{discovery: neighbours}").dds.discovery, Discovery::kNeighbours);
  EXPECT_EQ(read("{discovery: neighbours, interfaces: [127.0.0.2]}").dds.discovery, Discovery::kNeighbours);
  EXPECT_THROW(read("{discovery: neighbours, interfaces: [10.0.0.1]}"), BadConfig);
  EXPECT_THROW(read("{discovery: neighbours, peers: [127.0.0.1]}"), BadConfig);
  EXPECT_THROW(read("{discovery: neighbours, hub: 10.0.0.1}"), BadConfig) << "interfaces has loopback only";
  const Dds site = read("{discovery: neighbours, interfaces: [10.0.0.2], hub: 10.0.0.1, peers: [10.0.1.1]}").dds;
  EXPECT_EQ(site.hub, "10.0.0.1");
  EXPECT_EQ(site.peers, std::vector<std::string>{"10.0.1.1"});
  EXPECT_THROW(read("{discovery: neighbours, interfaces: [\"*\"], hub: 10.0.0.1}"), BadConfig);
  EXPECT_THROW(read("{discovery: neighbours, interfaces: [10.0.0.2], hub: hub.example}"), BadConfig);
  EXPECT_THROW(read("{discovery: multicast, hub: hub.example}"), BadConfig);
  workspace.write("keys/ca.pem", "");
  EXPECT_EQ(read("{discovery: neighbours, security: keys}").dds.discovery, Discovery::kNeighbours);
  EXPECT_THROW(read("{discovery: neighbours, interfaces: [10.0.0.2], hub: 10.0.0.1, security: keys}"), BadConfig);
}

TEST(LaunchFile, SaysOfTheNetworkOnlyWhatItWasTold) {
  const Workspace workspace;
  EXPECT_FALSE(workspace.launch(kSmallLaunch).dds.impair.delay_s) << "or it would win over the profile";
  const std::string file = kSmallLaunch + std::string("dds: {impair: {delay: 0.016, jitter: 5e-3, reorder: true}}\n");
  const Impair impair = workspace.launch(file, {"dds.impair.delay=0.008", "dds.impair.seed=9"}).dds.impair;
  EXPECT_EQ(impair.delay_s, 0.008);
  EXPECT_EQ(impair.jitter_s, 0.005);
  EXPECT_EQ(impair.reorder, true);
  EXPECT_EQ(impair.seed, 9U);
  EXPECT_FALSE(impair.loss || impair.bandwidth_B_s || impair.discovery);
}

TEST(LaunchFile, PathsAreRelativeToTheFileTheyStandIn) {
  const Workspace workspace;
  workspace.write("a/b/scene.yaml", kSmallScene);
  const auto file = workspace.write("a/launch.yaml", "scene: b/scene.yaml\nregions: {count: 1}\n");
  EXPECT_EQ(read_launch(file).scene_file, workspace.folder() / "a/b/scene.yaml");
  EXPECT_EQ(read_launch(workspace.folder() / "a/b/../launch.yaml").file, file);
}

TEST(LaunchFile, LookaheadCoversFrameAndLatency) {
  const Workspace workspace;
  const auto lookahead = [&](const std::string& tolerances) {
    return workspace.launch(kSmallLaunch + ("tolerances: " + tolerances + "\n")).lookahead();
  };
  EXPECT_EQ(lookahead("{frame: 0.015, latency: 0.001}"), 1);
  EXPECT_EQ(lookahead("{frame: 0.015, latency: 0.002}"), 2);
  EXPECT_EQ(lookahead("{frame: 0.001, latency: 0}"), 1);
  EXPECT_EQ(lookahead("{frame: 0.05, latency: 0}"), 3) << "exactly three steps";
  EXPECT_EQ(workspace.launch(std::string(kSmallLaunch) + "time: {lookahead: auto}\n").lookahead(), 2);
  EXPECT_EQ(workspace.launch(std::string(kSmallLaunch) + "time: {lookahead: 5}\n").lookahead(), 5);
}

TEST(LaunchFile, NeighboursListenAtLeastAsFarAsBodiesProject) {
  const Workspace workspace;
  const Launch slow = workspace.launch(std::string(kSmallLaunch) + "tolerances: {speed: 10}\n");
  const Launch fast = workspace.launch(std::string(kSmallLaunch) + "tolerances: {speed: 32}\n");
  EXPECT_GT(slow.neighbour_distance_m, 0);
  EXPECT_GT(fast.neighbour_distance_m, slow.neighbour_distance_m);
}

TEST(LaunchFile, AliasesOfYamlWork) {
  const Workspace workspace;
  const Launch launch = workspace.launch(
      "scene: scene.yaml\nregions: {layout: columns, count: &n 2, width: 40}\ntime: {substeps: *n, lookahead: *n}\n");
  EXPECT_EQ(launch.time.substeps, 2);
  EXPECT_EQ(launch.time.lookahead, 2);
}

}  // namespace
}  // namespace aurasim::config
