// The state in which a run stands is checked before anybody sees it: it is that of one world, also where the auras have
// missed a touch, and though no later state exists.
#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"
#include "physics/state_hash.h"

namespace aurasim::test {
namespace {

using core::AuraKind;
using core::Step;

constexpr Step kStates = 90;

ClusterOptions options_for(int seed, AuraKind kind) {
  ClusterOptions options = checked_options(seed);
  options.map = seed % 3 == 0 ? core::RegionMap::columns(4, kCell / 2) : core::RegionMap::grid(2, 2, kCell, kCell);
  if (seed % 3 == 0) options.neighbour_distance_m = 0.1;  // three hops from one end to the other
  options.aura.kind = kind;
  options.aura.lookahead = 1 + seed % 3;
  options.aura.substeps = 1 << (seed % 3);
  return options;
}

/// Hash of the state in which the run stands: of the bodies that are hosted and of those that join later.
std::uint64_t hash_of(lab::VirtualCluster& cluster, Step state) {
  std::uint64_t sum = 0;
  for (std::size_t r = 0; r < cluster.size(); ++r) {
    EXPECT_EQ(cluster.node(r).current_step(), state);
    for (const core::BodyRecord& body : cluster.records(r)) sum += physics::state_hash(body);
    for (const node::MadeUp& made_up : cluster.node(r).foresee()) {
      if (made_up.step != state) continue;
      for (const core::BodyRecord& body : made_up.bodies) sum += physics::state_hash(body);
    }
    for (const core::HandOff& hand_off : cluster.node(r).protocol().intake().to_come()) {
      if (hand_off.stamp != state) continue;  // left in this very state
      for (const core::BodyRecord& body : hand_off.cluster.bodies) {
        if (body.birth <= state) sum += physics::state_hash(body);
      }
    }
  }
  return sum;
}

struct Standing {
  Step first_difference = kStates + 1;
  std::uint32_t redos = 0;
};

/// Stands in every `every`th state, and compares it with the one world's.
Standing stand_often(int seed, AuraKind kind, Step every) {
  const core::Scene scene = thrown_bodies(40, 2 * kCell, 2 * kCell, 12, static_cast<std::uint64_t>(seed));
  const ClusterOptions options = options_for(seed, kind);
  const Outcome central = run_central(scene, options, kStates);
  lab::VirtualCluster cluster(scene, options.map, options);
  Standing found;
  for (Step state = 0; state <= kStates; state += every) {
    cluster.stand_in(state);
    const bool differs = hash_of(cluster, state) != central.hash[static_cast<std::size_t>(state)];
    if (differs) found.first_difference = std::min(found.first_difference, state);
  }
  found.redos = cluster.node(0).redos();
  return found;
}

class StandingStates : public testing::TestWithParam<int> {};

TEST_P(StandingStates, AreThoseOfOneWorldWhereNoAuraWarns) {
  for (const Step every : {1, 3, 10}) {
    const Standing found = stand_often(GetParam(), AuraKind::kNone, every);
    EXPECT_EQ(found.first_difference, kStates + 1) << "every " << every << ", " << found.redos << " redos";
  }
}

TEST_P(StandingStates, AreThoseOfOneWorldWhereAurasWarn) {
  EXPECT_EQ(stand_often(GetParam(), AuraKind::kSwept, 1).first_difference, kStates + 1);
}

TEST(StandingState, IsComputedAgainWhereNoAuraWarns) {
  for (int seed = 1; seed <= 3; ++seed) EXPECT_GT(stand_often(seed, AuraKind::kNone, 1).redos, 0u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, StandingStates, testing::Range(1, 1 + seeds_or(6)));

}  // namespace
}  // namespace aurasim::test
