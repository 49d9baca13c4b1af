// Random worlds: the same from the same seed, readable, with all that hurts in them; a trial that can fail, and a
// failing world made small.
#include "lab/scenes/scenes.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "config/launch.h"
#include "core/fnv1a.h"
#include "lab/scenes/interference.h"
#include "lab/scenes/random_world.h"
#include "lab/scenes/shrink.h"
#include "scratch_folder.h"
#include "setup/launch_setup.h"

namespace aurasim::lab {
namespace {

const std::atomic<bool> kUnstopped = false;

class Scenes : public testing::Test {
 protected:
  static TrialRules rules(core::Step steps) {
    TrialRules rules;
    rules.steps = steps;
    rules.setup_of = [](const config::Launch& launch, core::RegionId region) {
      return setup::node_setup(launch, region, 0);
    };
    return rules;
  }

  WorldOutcome outcome_of(const World& world, const TrialRules& rules) const {
    write_world(world, folder_);
    return run_world(folder_, rules, 1, kUnstopped).value();
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

std::string text_of(const World& world) {
  std::string text = world.scene.dump() + world.launch.dump() + world.interference.dump();
  for (const auto& [name, mesh] : world.meshes) text += name + mesh;
  return text;
}

TEST_F(Scenes, TheSameSeedGivesTheSameFiles) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_EQ(text_of(random_world(seed)), text_of(random_world(seed)));
    EXPECT_NE(text_of(random_world(seed)), text_of(random_world(seed + 1)));
  }
}

/// On every machine. Whoever changes what seeds mean writes the new number here.
TEST_F(Scenes, ASeedMeansTheSameWorldEverywhere) {
  core::Fnv1a hash;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) hash.add_text(text_of(random_world(seed)));
  EXPECT_EQ(hash.value(), 4523807717225671825ull);
}

TEST_F(Scenes, EveryWorldIsRead) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    write_world(random_world(seed), folder_);
    const config::Launch launch = config::read_launch(folder_ / kLaunchFile);
    EXPECT_GE(launch.regions.size(), 2u);
    EXPECT_LE(launch.regions.size(), 9u);
    EXPECT_GT(launch.scene.bodies.size(), 5u);
    EXPECT_NO_THROW(read_interference(folder_ / kInterferenceFile, launch.scene)) << "seed " << seed;
  }
}

TEST_F(Scenes, TheWorldsHaveAllThatHurts) {
  std::string all;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) all += text_of(random_world(seed));
  for (const char* word : {R"("sphere":)",
                           R"("capsule":)",
                           R"("cylinder":)",
                           R"("box":)",
                           R"("convex_hull":)",
                           R"("compound":)",
                           R"("plane":)",
                           R"("heightfield":)",
                           R"("mesh":)",
                           R"("ball":)",
                           R"("hinge":)",
                           R"("slider":)",
                           R"("fixed":)",
                           R"("spring":)",
                           R"("motor":)",
                           R"("limits_deg":)",
                           R"("limits":)",
                           R"("break_impulse":)",
                           R"("columns")",
                           R"("grid")",
                           R"("brick")",
                           R"("boxes")",
                           R"("lookahead":1)",
                           R"("lookahead":2)",
                           R"("lookahead":3)",
                           R"("substeps":1)",
                           R"("substeps":2)",
                           R"("substeps":3)",
                           R"("substeps":4)",
                           R"("soft_step")",
                           R"("sequential_impulse")",
                           R"("injectors":)",
                           R"("continuous":)",
                           R"("restitution":1.0)",
                           R"("spawn":)",
                           R"("remove_body":)",
                           R"("impulse":)",
                           R"("set_velocity":)",
                           R"("add_static":)",
                           R"("remove_static":)",
                           R"("move_static":)",
                           R"("path":)",
                           R"("belt":)",
                           R"("quantity":"force")",
                           R"("quantity":"torque")",
                           R"("quantity":"velocity")",
                           R"("quantity":"spin")",
                           R"("quantity":"driving")",
                           R"("drive":)",
                           R"("on_silence":"hold")",
                           R"("on_silence":"zero")",
                           R"("on_silence":"last")",
                           R"("can_sleep":false)",
                           R"("linear_damping":)"}) {
    EXPECT_NE(all.find(word), std::string::npos) << word;
  }
}

TEST_F(Scenes, AWorldIsTheSameOnItsRegionsAsOnOneNode) {
  const WorldOutcome outcome = outcome_of(random_world(1), rules(120));
  EXPECT_EQ(outcome.error, "");
  EXPECT_FALSE(outcome.first_difference);
  EXPECT_GT(outcome.hand_offs, 0u);
}

TEST_F(Scenes, ABadNetworkChangesNothing) {
  TrialRules bad = rules(120);
  bad.bad_network = true;
  const WorldOutcome outcome = outcome_of(random_world(1), bad);
  EXPECT_EQ(outcome.error, "");
  EXPECT_FALSE(outcome.first_difference);
}

/// A check that can fail: with no auras bodies meet on two nodes.
TEST_F(Scenes, WithoutAurasAWorldDiffersAndShrinksToOneThatStillDoes) {
  TrialRules blind = rules(100);
  blind.overrides = {"aura.radius=none", "time.redo=off"};
  World world = random_world(1);
  world.scene.erase("injectors");  // not every world has all lists
  const WorldOutcome failure = outcome_of(world, blind);
  ASSERT_TRUE(failure.first_difference);
  constexpr double kBudget_s = 5;
  const Shrunk shrunk = shrink(world, failure, blind, 1, kBudget_s, folder_, kUnstopped);
  EXPECT_LT(shrunk.world.scene["bodies"].size(), world.scene["bodies"].size() / 2);
  EXPECT_LE(shrunk.steps, *failure.first_difference);
  blind.steps = shrunk.steps;
  EXPECT_TRUE(outcome_of(shrunk.world, blind).first_difference);
}

TEST_F(Scenes, ACampaignGoesOnWhereItStoppedAndRefusesOtherRules) {
  ScenesPlan plan;
  plan.first = 1, plan.last = 2;
  plan.rules = rules(20);
  plan.shrink_s = 0;
  int shown = 0;
  const auto show = [&](double) { return ++shown > 0; };
  EXPECT_TRUE(run_scenes(plan, folder_, 1, show, kUnstopped));
  EXPECT_EQ(shown, 2);
  std::ofstream(folder_ / "seeds.csv", std::ios::app) << "3,1,";  // cut off by a crash
  plan.last = 4;
  EXPECT_TRUE(run_scenes(plan, folder_, 2, show, kUnstopped));
  EXPECT_EQ(shown, 4);
  const nlohmann::json sums = summarise_scenes(plan, folder_);
  EXPECT_EQ(sums["seeds"], 4);
  EXPECT_EQ(sums["differ"], 0);
  plan.rules.steps = 21;
  EXPECT_THROW(run_scenes(plan, folder_, 1, show, kUnstopped), std::runtime_error);
}

TEST_F(Scenes, AFailingSeedStaysWithItsShrunkWorld) {
  ScenesPlan plan;
  plan.first = plan.last = 1;
  plan.rules = rules(100);
  plan.rules.overrides = {"aura.radius=none", "time.redo=off"};
  plan.shrink_s = 1;
  EXPECT_TRUE(run_scenes(
      plan, folder_, 1, [](double) { return true; }, kUnstopped));
  EXPECT_EQ(summarise_scenes(plan, folder_)["failed_seeds"], nlohmann::json::array({1}));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "seed_1" / kLaunchFile));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "seed_1" / "shrunk" / "README.md"));
  EXPECT_NO_THROW(config::read_launch(folder_ / "seed_1" / "shrunk" / kLaunchFile));
}

TEST_F(Scenes, CoupledRegionsHaveTheBitsOfOneNode) {
  TrialRules coupled = rules(200);
  coupled.overrides = {"exchange=coupled", "physics.solver=soft_step", "physics.block=2"};
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const WorldOutcome outcome = outcome_of(random_world(seed), coupled);
    EXPECT_EQ(outcome.error, "") << "seed " << seed;
    EXPECT_EQ(outcome.first_difference, std::nullopt) << "seed " << seed;
  }
}

/// So many that a tree connects them (core/seam_tree.h), with and without deaths.
TEST_F(Scenes, ManyCoupledRegionsHaveTheBitsOfOneNode) {
  TrialRules many = rules(120);
  many.overrides = {"exchange=coupled", "physics.solver=soft_step", "physics.block=2",
                    "regions={layout: grid, rows: 3, columns: 4, cell: [5, 4]}"};
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    many.deaths = seed % 2 == 0 ? 2 : 0;
    const WorldOutcome outcome = outcome_of(random_world(seed), many);
    EXPECT_EQ(outcome.error, "") << "seed " << seed;
    EXPECT_EQ(outcome.first_difference, std::nullopt) << "seed " << seed;
  }
}

/// Nodes die in the middle of a step, and the others stand in it (VirtualCluster::crash_in_step).
TEST_F(Scenes, CoupledRegionsWhoseNodesDieHaveTheBitsOfOneNode) {
  TrialRules deadly = rules(200);
  deadly.overrides = {"exchange=coupled", "physics.solver=soft_step", "physics.block=2"};
  deadly.deaths = 3;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const WorldOutcome outcome = outcome_of(random_world(seed), deadly);
    EXPECT_EQ(outcome.error, "") << "seed " << seed;
    EXPECT_EQ(outcome.first_difference, std::nullopt) << "seed " << seed;
  }
}

}  // namespace
}  // namespace aurasim::lab
