// What is computed with two bodies apart that touch is found, and computed again: the world is that of one node,
// whatever the auras have missed.
#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"
#include "core/horizon.h"

namespace aurasim::test {
namespace {

using core::AuraKind;

constexpr core::Step kRedoSteps = 150;

ClusterOptions options_for(int seed) {
  ClusterOptions options = checked_options(seed);
  options.map = seed % 2 == 0 ? core::RegionMap::columns(2, kCell) : core::RegionMap::grid(2, 2, kCell, kCell);
  options.aura.lookahead = 1 + seed % 3;
  options.aura.substeps = 1 << (seed % 3);
  return options;
}

core::Scene scene_for(int seed) {
  return thrown_bodies(40, 2 * kCell, 2 * kCell, 12, static_cast<std::uint64_t>(seed));
}

class Redo : public testing::TestWithParam<int> {};

TEST_P(Redo, AloneGivesTheBitsOfOneWorld) {
  const core::Scene scene = scene_for(GetParam());
  ClusterOptions options = options_for(GetParam());
  options.aura.kind = AuraKind::kNone;
  const Outcome apart = CheckedRun(scene, options).run(kRedoSteps);
  const Outcome central = run_central(scene, options, kRedoSteps);
  EXPECT_EQ(first_difference(apart, central), kRedoSteps + 1) << apart.redos << " redos";
  EXPECT_EQ(apart.lost, 0u);
}

/// But for one world in two hundred, where something leaves its path by more than was promised.
TEST_P(Redo, IsHardlyEverNeededWhereAurasTell) {
  const core::Scene scene = scene_for(GetParam());
  const ClusterOptions options = options_for(GetParam());
  const Outcome apart = CheckedRun(scene, options).run(kRedoSteps);
  const Outcome central = run_central(scene, options, kRedoSteps);
  EXPECT_EQ(first_difference(apart, central), kRedoSteps + 1);
  EXPECT_LE(apart.redos, 1u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Redo, testing::Range(1, 1 + seeds_or(6)));

TEST(Check, FindsWhatAurasWouldHaveTold) {
  ClusterOptions options = options_for(1);
  options.aura.kind = AuraKind::kNone;
  const core::Scene scene = scene_for(1);
  CheckedRun run(scene, options);
  EXPECT_GT(run.run(kRedoSteps).redos, 0u);
  const node::TimeSpent& spent = run.node(0).time_spent();
  EXPECT_GT(spent.in_redos_s(), 0);
  EXPECT_LT(spent.in_redos_s(), spent.all_s());
}

/// Two balls that meet head-on over the border in state `touch`, or soon after it.
core::Scene two_balls(core::Step touch) {
  core::Scene scene;
  scene.gravity = core::Vec3::Zero();
  scene.shapes = {{"ball", core::Sphere{0.5}}};
  scene.materials = {core::Material{}};
  scene.prototypes = {{"ball", 0, 0, 1, true}};
  constexpr double kSpeed_m_s = 6;
  for (int side : {-1, 1}) {
    core::InitialBody& ball = scene.bodies.emplace_back();
    ball.id = core::BodyId{scene.bodies.size() - 1};
    ball.pose.p_WB = {side * (0.5 + kSpeed_m_s * static_cast<double>(touch) / 60), 0, 2};
    ball.v_WB = {-side * kSpeed_m_s, 0, 0};
  }
  return scene;
}

TEST(WayBack, IsFarEnoughToBringTwoBodiesTogetherAtTheFirstTry) {
  for (int lookahead = 1; lookahead <= 4; ++lookahead) {
    for (core::Step touch = 60; touch < 60 + core::horizon::kBetweenCuts; ++touch) {
      ClusterOptions options = options_for(2);
      options.aura.lookahead = lookahead;
      options.aura.kind = AuraKind::kNone;
      const core::Scene scene = two_balls(touch);
      const Outcome apart = CheckedRun(scene, options).run(kRedoSteps);
      EXPECT_EQ(apart.redos, 1u) << "K = " << lookahead << ", touch in " << touch;
      EXPECT_LE(apart.again, std::uint64_t(core::horizon::check(lookahead) + core::horizon::kBetweenCuts + 1));
      EXPECT_EQ(first_difference(apart, run_central(scene, options, kRedoSteps)), kRedoSteps + 1);
    }
  }
}

/// News of a touch cross a wide map as fast as messages do, not in steps of K states.
TEST(WayBack, IsShortOnAWideMap) {
  constexpr int kLookahead = 4, kColumns = 6;
  ClusterOptions options = options_for(2);
  options.map = core::RegionMap::columns(kColumns, kCell);
  options.aura.lookahead = kLookahead;
  options.aura.kind = AuraKind::kNone;
  const core::Scene scene = two_balls(60);
  const Outcome apart = CheckedRun(scene, options).run(kRedoSteps);
  EXPECT_EQ(first_difference(apart, run_central(scene, options, kRedoSteps)), kRedoSteps + 1);
  ASSERT_EQ(apart.redos, 1u);
  constexpr core::Step kRound = (kColumns - 1) * kLookahead;
  EXPECT_GT(apart.again, 0u);
  EXPECT_LT(apart.again, std::uint64_t{kRound + core::horizon::check(kLookahead)});
}

TEST(Check, WithoutItsMarginMissesATouch) {
  std::size_t differ = 0;
  for (int seed = 1; seed <= 6; ++seed) {
    ClusterOptions options = options_for(seed);
    options.aura.kind = AuraKind::kNone;
    options.aura.check_scale = -5;
    const core::Scene scene = scene_for(seed);
    const Outcome apart = CheckedRun(scene, options).run(kRedoSteps);
    differ += first_difference(apart, run_central(scene, options, kRedoSteps)) <= kRedoSteps;
  }
  EXPECT_GT(differ, 0u);
}

}  // namespace
}  // namespace aurasim::test
