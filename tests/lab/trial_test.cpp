// Single pairs, in one world and in several.
#include "lab/trial.h"

#include <gtest/gtest.h>

#include "lab/campaign.h"

namespace aurasim::lab {
namespace {

using core::SyncMode;

struct Sum {
  Tally tally;
  std::uint64_t apart = 0;
};

Sum try_pairs(PairKind kind, const Series& series, double value, const Variant& variant, int count) {
  const Conditions conditions = conditions_at(series, value, 1);
  Sum sum;
  for (int i = 1; i <= count; ++i) {
    Chance chance(static_cast<std::uint64_t>(i));
    const Pair pair = make_pair(kind, conditions, chance);
    const auto owner = [&](std::size_t b) { return pair.map.owner(pair.scene.bodies[b].pose.p_WB); };
    sum.apart += owner(0) != owner(1);
    const Disorder disorder = make_disorder(conditions, chance);
    sum.tally.add(run_pair(pair, conditions, variant, disorder, run_central(pair, conditions)));
  }
  return sum;
}

class EachKind : public testing::TestWithParam<PairKind> {};

TEST_P(EachKind, MeetsAcrossABorderAsInOneWorldToTheLastBit) {
  for (const Series& series : {thesis_series()[1], thesis_series()[5], thesis_series()[8]}) {
    const Sum sum = try_pairs(GetParam(), series, series.tolerance, {AuraChoice::kSwept, SyncMode::kBounded}, 12);
    EXPECT_EQ(sum.apart, 12u);
    EXPECT_GT(sum.tally.trials, 3u) << name_of(series);
    EXPECT_EQ(sum.tally.late + sum.tally.missed, 0u) << name_of(series);
    EXPECT_EQ(sum.tally.same_bits, sum.tally.trials) << name_of(series);
  }
}

TEST_P(EachKind, IsLateOrMissedWithoutAuras) {
  Tally total;
  for (const Series& series : {thesis_series()[1], thesis_series()[5], thesis_series()[8]}) {
    total.add(try_pairs(GetParam(), series, series.tolerance, {AuraChoice::kNone, SyncMode::kBounded}, 20).tally);
  }
  EXPECT_GT(total.late + total.missed, 0u);
}

INSTANTIATE_TEST_SUITE_P(Pairs, EachKind, testing::ValuesIn(kPairKinds),
                         [](const auto& info) { return std::string(name_of(info.param)); });

/// In one of these pairs a box joins in the state before the contact, overlapping the other by more than their centres'
/// speeds explain.
TEST(Trial, ASpinningCornerIsNotLateBecauseItIsFasterThanItsBody) {
  Campaign campaign;
  campaign.variants = {{AuraChoice::kSwept, SyncMode::kBounded}};
  for (const Trial& trial : run_job(campaign, {PairKind::kBoxes, thesis_series()[0], 8})) {
    EXPECT_FALSE(trial.late() || trial.missed()) << "repeat " << trial.repeat;
  }
}

TEST(Trial, NoPairIsHandedOverBeforeTheNodesTalk) {
  for (const Series& series : thesis_series()) {
    for (const AuraChoice aura : {AuraChoice::kThesis, AuraChoice::kTight, AuraChoice::kSwept}) {
      const Sum sum = try_pairs(PairKind::kHeadOn, series, series.values.back(), {aura, SyncMode::kBounded}, 2);
      EXPECT_EQ(sum.tally.thrashed, 0u) << name_of(series) << " " << name_of(aura);
    }
  }
}

/// The first pull comes 13 steps before the contact here, with both bodies over the other region already.
TEST(Trial, APairDoesNotGoHomeBetweenThePullAndTheContact) {
  Campaign campaign;
  campaign.variants = {{AuraChoice::kSwept, SyncMode::kBounded}};
  for (const auto& [series, value] : {std::pair{0, 8.0}, {1, 16.0}}) {
    for (const Trial& trial : run_job(campaign, {PairKind::kRandom, thesis_series()[series], value})) {
      EXPECT_FALSE(trial.thrashed()) << name_of(thesis_series()[series]) << ", repeat " << trial.repeat;
    }
  }
}

TEST(Trial, AtTheStartEachBodyIsHostedWhereItIs) {
  for (const Series& series : thesis_series()) {
    const Conditions conditions = conditions_at(series, series.values.back(), 1);
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Chance chance(seed);
      const Pair pair = make_pair(PairKind::kRandom, conditions, chance);
      const ClusterRules rules = rules_of(conditions, {AuraChoice::kSwept, SyncMode::kBounded}, {});
      VirtualCluster cluster(pair.scene, pair.map, rules);
      for (std::size_t region = 0; region < cluster.size(); ++region) {
        EXPECT_EQ(cluster.records(region).size(), 1u) << name_of(series) << ", seed " << seed << ", region " << region;
      }
    }
  }
}

TEST(Trial, ASpeedThatIsNotPromisedIsALateCollisionThatWasFlagged) {
  Tally total;
  for (const double speed : {50.0, 64.0}) {
    total.add(try_pairs(PairKind::kHeadOn, thesis_series()[1], speed, {AuraChoice::kTight, SyncMode::kFreeRunning}, 60)
                  .tally);
  }
  EXPECT_GT(total.late, 0u);
  EXPECT_EQ(total.late_without_violation, 0u);
  EXPECT_EQ(total.with_violations, total.trials);
}

TEST(Trial, WhenDatagramsAreLostBoundedNodesWaitAndAreNeverLate) {
  const Tally free =
      try_pairs(PairKind::kHeadOn, loss_series(), 0.2, {AuraChoice::kTight, SyncMode::kFreeRunning}, 60).tally;
  const Tally bounded =
      try_pairs(PairKind::kHeadOn, loss_series(), 0.2, {AuraChoice::kTight, SyncMode::kBounded}, 60).tally;
  EXPECT_GT(free.late, 0u) << "the losses can be felt";
  EXPECT_EQ(bounded.late + bounded.missed, 0u);
  EXPECT_EQ(bounded.same_bits, bounded.trials);
  EXPECT_GT(bounded.slow_down_most, 1.0);
}

TEST(Trial, ALostDatagramCostsAHeartbeatAndARoundTrip) {
  Conditions c;
  c.latency_s = 0.002;
  EXPECT_DOUBLE_EQ(resend_after_s(c), 0.009);
}

}  // namespace
}  // namespace aurasim::lab
