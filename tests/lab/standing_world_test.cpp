// The world in which a run stands: a run goes on from it with the bits that it would have had, though the nodes were
// told only then that it would be wanted.
#include <atomic>
#include <filesystem>

#include <gtest/gtest.h>

#include "config/launch.h"
#include "core/world_cut.h"
#include "lab/launch_rules.h"
#include "lab/scenes/endurance.h"
#include "lab/scenes/play.h"
#include "setup/launch_setup.h"

namespace aurasim::lab {
namespace {

using core::Step;

const std::atomic<bool> kGoOn = false;

node::NodeSetup setup_of(const config::Launch& launch, core::RegionId region) {
  return setup::node_setup(launch, region, 0);
}

config::Launch launch_of(const char* name, const std::string& sync = "deterministic") {
  return config::read_launch(std::filesystem::path(AURASIM_SOURCE_DIR) / "launch_configs" / name,
                             {"time.sync=" + sync});
}

class StandingWorlds : public testing::Test {
 protected:
  void use(const char* name, const std::string& sync = "deterministic") {
    launch_.emplace(launch_of(name, sync));
    rules_ = launch_rules(*launch_, setup_of);
    rules_.hash_states = true;
    cluster_.emplace(launch_->scene, launch_->regions, rules_);
  }

  core::WorldCut world() {
    std::vector<core::WorldCut> parts;
    for (std::size_t r = 0; r < cluster_->size(); ++r) {
      std::optional<core::WorldCut> part = cluster_->node(r).present_part();
      EXPECT_TRUE(part) << "region " << r;
      if (part) parts.push_back(std::move(*part));
    }
    return through_a_file(core::merge(std::move(parts)));
  }

  Played play_on(std::size_t nodes, Step until, const core::WorldCut* world) {
    const core::RegionMap map = nodes == 4 ? launch_->regions : core::RegionMap::columns(nodes, 12);
    VirtualCluster cluster(launch_->scene, map, rules_, world);
    Interference none;
    return play(cluster, none, until, launch_->lookahead(), kGoOn, nullptr, world).value();
  }

  std::optional<config::Launch> launch_;
  ClusterRules rules_;
  std::optional<VirtualCluster> cluster_;
};

TEST_F(StandingWorlds, GoOnWithTheSameBitsFromAnyState) {
  constexpr Step kUntil = 260;
  use("corner_stacks.yaml");
  const Played wanted = play_on(4, kUntil, nullptr);
  std::size_t under_way = 0;
  for (const Step step : {0, 1, 2, 17, 58, 61, 90, 133, 170}) {
    use("corner_stacks.yaml");
    cluster_->stand_in(step);
    const core::WorldCut world = this->world();
    EXPECT_EQ(world.step, step);
    under_way += world.under_way.size();
    for (const std::size_t nodes : {1, 2, 4}) {
      const Played found = play_on(nodes, kUntil, &world);
      for (Step n = step; n <= kUntil; ++n) {
        ASSERT_EQ(found.hash[static_cast<std::size_t>(n)], wanted.hash[static_cast<std::size_t>(n)])
            << "state " << n << " from " << step << " on " << nodes;
      }
    }
  }
  EXPECT_GT(under_way, 0U) << "or this test proves less than it says";
}

TEST_F(StandingWorlds, AreThereInEveryWayToWait) {
  for (const char* sync : {"deterministic", "bounded", "free_running"}) {
    use("tug_of_war.yaml", sync);
    cluster_->stand_in(100);
    EXPECT_EQ(core::body_count(world()), launch_->scene.bodies.size()) << sync << ": none is lost under way";
  }
}

/// An order that has been given in a pause, and that nobody has received yet.
TEST_F(StandingWorlds, KnowWhatIsOrderedInThePause) {
  use("corner_stacks.yaml");
  cluster_->stand_in(100);
  core::Spawn spawn;
  spawn.id = core::BodyId{core::kFirstClientBody + 1};
  spawn.pose.p_WB = {0, 0, 20};
  const core::Order given = cluster_->node(0).order(spawn, 77);
  const core::WorldCut world = this->world();
  ASSERT_EQ(world.orders.size(), 1U);
  EXPECT_EQ(world.orders.front().request, 77U);
  EXPECT_EQ(world.last_order, given.sequence);
  const core::RegionMap one = core::RegionMap::columns(1, 12);
  VirtualCluster loaded(launch_->scene, one, rules_, &world);
  while (loaded.slowest() < given.at_step) loaded.next();
  EXPECT_TRUE(loaded.node(0).world().contains(spawn.id));
}

TEST(Endurance, AShortOneHoldsTheSameRuleAsALongOne) {
  EndurancePlan plan;
  plan.hours = 60.0 / 3600;
  plan.setup_of = setup_of;
  const config::Launch launch = launch_of("tower.yaml");
  const Endured end = endure(
      launch, plan, [](const Endured&) {}, kGoOn);
  EXPECT_EQ(end.failure, "");
  EXPECT_GE(end.compared, 3600U);
  EXPECT_GT(end.deaths, 0U);
  EXPECT_GT(end.loads, 0U);
}

}  // namespace
}  // namespace aurasim::lab
