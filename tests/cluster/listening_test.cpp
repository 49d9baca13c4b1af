// Listening follows bodies: where they come to regions that did not listen to their host, the owner of the place has
// introduced the two in time.
#include <gtest/gtest.h>

#include "cluster/cluster_sim.h"
#include "cluster/scenes.h"

namespace aurasim::test {
namespace {

constexpr core::Step kSteps = 150;

/// Regions narrower than what bodies come across, and only those that touch listen to each other at first.
ClusterOptions options_for(int seed) {
  ClusterOptions options;
  options.sync = core::SyncMode::kDeterministic;
  options.seed = static_cast<std::uint64_t>(seed);
  options.map = seed % 2 == 0 ? core::RegionMap::columns(7, 2.5) : core::RegionMap::grid(3, 4, 4, 4);
  options.neighbour_distance_m = 0;
  options.aura.lookahead = 1 + seed % 2;
  options.aura.substeps = 2;
  options.aura.top_speed_m_s = 40;
  options.aura.redo = true;
  options.over_the_wire = true;
  options.faults.latency_s = 0.004 * (seed % 7);
  options.faults.jitter_s = 0.006 * (seed % 4);
  options.faults.keep_order = seed % 2 == 0;
  return options;
}

class Listening : public testing::TestWithParam<int> {};

TEST_P(Listening, FollowsBodiesSoThatNothingIsMissed) {
  const core::Scene scene = thrown_bodies(40, 16, 12, 12, static_cast<std::uint64_t>(GetParam()));
  ClusterSim apart(scene, options_for(GetParam()));
  const Outcome outcome = apart.run(kSteps);
  const Outcome central = run_central(scene, options_for(GetParam()), kSteps);
  EXPECT_EQ(outcome.hash, central.hash) << outcome.redos << " redos";
  EXPECT_EQ(outcome.lost, 0u);
  EXPECT_LE(outcome.redos, 2u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Listening, testing::Range(1, 1 + seeds_or(6)));

}  // namespace
}  // namespace aurasim::test
