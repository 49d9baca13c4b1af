// Each solver keeps the bits when bodies change hosts: none remembers what it solved before.
#include <iostream>

#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"
#include "physics/solver_names.h"

namespace aurasim::test {
namespace {

class SolverBits : public testing::TestWithParam<physics::Solver> {};

TEST_P(SolverBits, AreThoseOfTheCentralRun) {
  std::uint64_t hand_offs = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const core::Scene scene = thrown_bodies(50, 12, 12, 10, seed);
    ClusterOptions options;
    options.map = seed == 3 ? core::RegionMap::grid(2, 2, 9, 9) : core::RegionMap::columns(2, 9);
    options.sync = core::SyncMode::kDeterministic;
    options.physics.solver = GetParam();
    options.physics.friction_directions = static_cast<int>(1 + seed % 2);
    options.seed = seed;
    options.aura.lookahead = static_cast<int>(1 + seed % 2);
    options.aura.top_speed_m_s = 40;
    options.network.loss = 0.05;
    const Outcome o = CheckedRun(scene, options).run(180);
    EXPECT_EQ(o.hash, run_central(scene, options, 180).hash) << "seed " << seed;
    EXPECT_EQ(o.late + o.missed + o.lost + o.doubled, 0u) << "seed " << seed;
    hand_offs += o.hand_offs;
  }
  EXPECT_GT(hand_offs, 0u);
  std::cout << hand_offs << " hand-offs\n";
}

TEST_P(SolverBits, OfDrivenJointsAreThoseOfTheCentralRun) {
  std::uint64_t hand_offs = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const core::Scene scene = driven_pairs(40, 16, 16, 8, seed);
    ClusterOptions options;
    options.map = seed == 1 ? core::RegionMap::grid(2, 2, 9, 9) : core::RegionMap::columns(2, 9);
    options.sync = core::SyncMode::kDeterministic;
    options.physics.solver = GetParam();
    options.seed = seed;
    options.aura.lookahead = 1;
    options.aura.top_speed_m_s = 60;
    options.bandwidth_B_s = lab::kUnlimited_B_s;
    const Outcome o = CheckedRun(scene, options).run(240);
    EXPECT_EQ(o.hash, run_central(scene, options, 240).hash) << "seed " << seed;
    EXPECT_EQ(o.late + o.missed + o.lost + o.doubled, 0u) << "seed " << seed;
    hand_offs += o.hand_offs;
  }
  EXPECT_GT(hand_offs, 0u);
  std::cout << hand_offs << " hand-offs\n";
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverBits,
                         testing::Values(physics::Solver::kSequentialImpulse, physics::Solver::kSoftStep),
                         [](const auto& param) { return std::string(physics::name_of(param.param)); });

}  // namespace
}  // namespace aurasim::test
