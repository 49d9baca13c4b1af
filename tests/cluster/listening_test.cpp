// Listening follows bodies: where they come to regions that did not listen to their host, the owner of the place has
// introduced the two in time.
#include <algorithm>

#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"

namespace aurasim::test {
namespace {

constexpr core::Step kListeningSteps = 150;

/// Regions narrower than what bodies come across, and only those that touch listen to each other at first.
ClusterOptions listening_options_for(int seed) {
  ClusterOptions options = checked_options(seed);
  options.map = seed % 2 == 0 ? core::RegionMap::columns(7, 2.5) : core::RegionMap::grid(3, 4, 4, 4);
  options.neighbour_distance_m = 0;
  options.aura.lookahead = 1 + seed % 2;
  options.aura.substeps = 2;
  return options;
}

class Listening : public testing::TestWithParam<int> {};

TEST_P(Listening, FollowsBodiesSoThatNothingIsMissed) {
  const core::Scene scene = thrown_bodies(40, 16, 12, 12, static_cast<std::uint64_t>(GetParam()));
  CheckedRun apart(scene, listening_options_for(GetParam()));
  const Outcome outcome = apart.run(kListeningSteps);
  const Outcome central = run_central(scene, listening_options_for(GetParam()), kListeningSteps);
  EXPECT_EQ(outcome.hash, central.hash) << outcome.redos << " redos";
  EXPECT_EQ(outcome.lost, 0u);
  EXPECT_LE(outcome.redos, 2u);
}

/// Both sides say the same of it.
TEST_P(Listening, IsMutualFromTheSameStateOn) {
  const core::Scene scene = thrown_bodies(40, 16, 12, 12, static_cast<std::uint64_t>(GetParam()));
  const ClusterOptions options = listening_options_for(GetParam());
  CheckedRun apart(scene, options);
  apart.run(kListeningSteps);
  const auto listened = [&](core::RegionId region) {
    return apart.node(core::value_of(region)).protocol().listens_to();
  };
  std::size_t introduced = 0;
  for (std::uint32_t r = 0; r < options.map.size(); ++r) {
    for (const core::Listened& other : listened(core::RegionId{r})) {
      if (other.since > kListeningSteps) continue;  // nodes end a few states apart
      introduced += other.introduced_by.has_value();
      const auto same = std::ranges::find(listened(other.region), core::RegionId{r}, &core::Listened::region);
      ASSERT_NE(same, listened(other.region).end()) << r << " listens to " << core::value_of(other.region);
      EXPECT_EQ(same->since, other.since);
      EXPECT_EQ(same->introduced_by.has_value(), other.introduced_by.has_value());
    }
  }
  const bool narrow_columns = GetParam() % 2 == 0;  // all have been near each other from the start
  EXPECT_TRUE(narrow_columns || introduced > 0);
}

/// Bodies come to rest, so most regions that they have brought together have nothing to say to each other any more.
TEST_P(Listening, EndsWhereNothingMovesAndNothingIsMissed) {
  constexpr core::Step kUntilRest = 700;
  const core::Scene scene = thrown_bodies(40, 16, 12, 12, static_cast<std::uint64_t>(GetParam()));
  ClusterOptions options = listening_options_for(GetParam());
  options.map = core::RegionMap::grid(3, 4, 4, 4);
  options.aura.lookahead = 2;
  CheckedRun apart(scene, options);
  std::ptrdiff_t in_flight = 0, at_rest = 0;
  apart.on_state = [&](const node::Node& node, const node::StepReport& report, double) {
    if (report.step != kListeningSteps && report.step != kUntilRest) return;
    (report.step == kListeningSteps ? in_flight : at_rest) += std::ranges::count_if(
        node.protocol().listens_to(), [](const core::Listened& other) { return other.introduced_by.has_value(); });
  };
  const Outcome outcome = apart.run(kUntilRest);
  EXPECT_LT(at_rest, in_flight);
  EXPECT_EQ(outcome.hash, run_central(scene, options, kUntilRest).hash) << outcome.redos << " redos";
  EXPECT_EQ(outcome.lost, 0u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Listening, testing::Range(1, 1 + seeds_or(6)));

}  // namespace
}  // namespace aurasim::test
