// What a launch file means to nodes, transports and worlds.
#include "setup/launch_setup.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/workspace.h"
#include "physics/soft/threads.h"

namespace aurasim::setup {
namespace {

using config::kSmallLaunch;
using core::RegionId;
using ::testing::ElementsAre;

config::Launch launch_of(const std::string& more) {
  static const config::Workspace workspace;
  return workspace.launch(kSmallLaunch + more);
}

TEST(DdsSettings, AreThoseOfTheFile) {
  const dds::Settings settings = dds_settings(launch_of(
      "dds: {domain: 7, discovery: peers, interfaces: [10.0.0.1], peers: [10.0.0.2], impair: {loss: 0.1}}\n"));
  EXPECT_EQ(settings.domain, 7U);
  EXPECT_EQ(settings.discovery, config::Discovery::kPeers);
  EXPECT_THAT(settings.interfaces, ElementsAre("10.0.0.1"));
  EXPECT_THAT(settings.peers, ElementsAre("10.0.0.2"));
  EXPECT_EQ(settings.impairment.loss, 0.1);
  EXPECT_FALSE(settings.impairment.delay_s);
}

TEST(DdsSettings, OfTwoNodesLoseOtherDatagramsOfTheSameSeed) {
  const config::Launch launch = launch_of("dds: {impair: {loss: 0.1, seed: 3}}\n");
  const auto stream = [&](std::optional<RegionId> region) { return dds_settings(launch, region).impairment_stream; };
  EXPECT_NE(stream(RegionId{0}), stream(RegionId{1}));
  EXPECT_NE(stream(RegionId{0}), stream({})) << "a process that only watches";
}

TEST(ThreadsOfANode, AreItsShareOfTheCores) {
  const int cores = physics::soft::usable_cores();
  EXPECT_EQ(threads_of(launch_of(""), 1), std::min(64, cores));
  EXPECT_EQ(threads_of(launch_of(""), 2), std::clamp(cores / 2, 1, 64));
  EXPECT_EQ(threads_of(launch_of(""), static_cast<std::size_t>(cores) + 1), 1);
  EXPECT_EQ(threads_of(launch_of("physics: {threads: 5}\n"), 1000), 5);
}

TEST(ThreadsOfANode, AreNotPartOfTheAgreement) {
  EXPECT_EQ(launch_of("physics: {threads: 1}\n").agreement(), launch_of("physics: {threads: 2}\n").agreement());
  EXPECT_EQ(launch_of("physics: {threads: 1}\n").agreement(), launch_of("").agreement());
}

TEST(AuraRules, AreThoseOfTheFile) {
  const core::AuraRules rules =
      aura_rules(launch_of("time: {step_hz: 50, substeps: 3, lookahead: 4}\ntolerances: {speed: 20}\naura: {radius: "
                           "tight, uncertainty: 0.25}\n"));
  EXPECT_EQ(rules.kind, core::AuraKind::kTight);
  EXPECT_DOUBLE_EQ(rules.step_s, 0.02);
  EXPECT_EQ(rules.substeps, 3);
  EXPECT_EQ(rules.lookahead, 4);
  EXPECT_EQ(rules.top_speed_m_s, 20);
  EXPECT_EQ(rules.uncertainty, 0.25);
}

TEST(AuraRules, KnowEveryKindByItsName) {
  for (const auto& [name, kind] :
       {std::pair{"none", core::AuraKind::kNone}, std::pair{"thesis", core::AuraKind::kThesis},
        std::pair{"tight", core::AuraKind::kTight}, std::pair{"swept", core::AuraKind::kSwept}}) {
    EXPECT_EQ(aura_rules(launch_of(std::string("aura: {radius: ") + name + "}\n")).kind, kind) << name;
  }
}

TEST(NodeSetup, KnowsItsRegionItsGenerationAndItsMode) {
  for (const auto& [name, mode] :
       {std::pair{"free_running", core::SyncMode::kFreeRunning}, std::pair{"bounded", core::SyncMode::kBounded},
        std::pair{"deterministic", core::SyncMode::kDeterministic}}) {
    const config::Launch launch = launch_of(std::string("time: {sync: ") + name + "}\n");
    const node::NodeSetup setup = node_setup(launch, RegionId{1}, 5);
    EXPECT_EQ(setup.protocol.sync, mode) << name;
    EXPECT_EQ(setup.protocol.self, RegionId{1});
    EXPECT_EQ(setup.protocol.generation, 5U);
    EXPECT_EQ(setup.physics.step_s, launch.step_s());
  }
}

TEST(WorldMap, NamesSceneRegionsAndWhatAllMustAgreeOn) {
  const config::Launch launch = launch_of("");
  const messages::WorldMap map = world_map(launch);
  EXPECT_EQ(map.regions.size(), 2U);
  EXPECT_EQ(map.map_version, launch.regions.version());
  EXPECT_EQ(map.agreement, launch.agreement());
  EXPECT_EQ(map.scene, launch.scene.name);
}

}  // namespace
}  // namespace aurasim::setup
