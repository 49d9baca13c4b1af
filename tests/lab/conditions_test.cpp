// The thesis's series, and what auras they make.
#include "lab/conditions.h"

#include <gtest/gtest.h>

#include "core/aura.h"
#include "lab/aura_radius.h"

namespace aurasim::lab {
namespace {

TEST(Series, AreTheNineOfTheThesisUpToDoubleTheTolerance) {
  const std::vector<std::size_t> counts = {32, 64, 96, 81, 65, 33, 18, 31, 35};
  const std::vector<Series> all = thesis_series();
  ASSERT_EQ(all.size(), counts.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].values.size(), counts[i]) << name_of(all[i]);
    EXPECT_NEAR(all[i].values.back(), 2 * all[i].tolerance, 1e-9) << name_of(all[i]);
  }
}

TEST(Series, NamesSayFactorAndTolerance) {
  EXPECT_EQ(name_of(thesis_series()[1]), "speed_32m_s");
  EXPECT_EQ(name_of(thesis_series()[6]), "frame_8.33ms");
  EXPECT_EQ(name_of(loss_series()), "loss");
}

TEST(Series, ThinnedKeepsTheLargestValue) {
  const Series few = thinned(thesis_series()[0], 4);
  EXPECT_EQ(few.values, (std::vector<double>{8, 16, 24, 32}));
  EXPECT_EQ(thinned(few, 0).values.size(), 4u);
}

TEST(Series, TheToleranceItselfIsKept) {
  for (const Series& series : thesis_series()) {
    EXPECT_TRUE(within_tolerance(series, series.tolerance));
    EXPECT_FALSE(within_tolerance(series, series.tolerance * 1.01));
  }
}

TEST(Conditions, TheOtherFactorsAreAtTheirTolerances) {
  const Conditions c = conditions_at(thesis_series()[5], 0.004, 1);
  EXPECT_DOUBLE_EQ(c.promised.latency_s, 0.016);
  EXPECT_DOUBLE_EQ(c.latency_s, 0.004);
  EXPECT_DOUBLE_EQ(c.speed_m_s, c.promised.speed_m_s);
  EXPECT_DOUBLE_EQ(c.frame_s, c.promised.frame_s);
}

TEST(AuraRadius, IsTheThesissOwnAtItsTolerances) {
  const Conditions c = conditions_at(thesis_series()[1], 32, 1);
  EXPECT_EQ(lookahead(c.promised), 2);
  EXPECT_NEAR(aura_reach_m(AuraChoice::kThesis, c), 5 * 32 / 60.0, 1e-9);
  EXPECT_NEAR(aura_reach_m(AuraChoice::kTight, c), 4 * 32 / 60.0, 1e-9);
  EXPECT_NEAR(aura_reach_m(AuraChoice::kTightAtThesisSize, c), aura_reach_m(AuraChoice::kThesis, c), 1e-9);
}

TEST(AuraRadius, HeadOnReachOfASphereAuraIsItsRadiusAndMargin) {
  const Conditions c = conditions_at(thesis_series()[1], 32, 1);
  EXPECT_NEAR(head_on_reach_m(AuraChoice::kTight, c),
              aura_reach_m(AuraChoice::kTight, c) + core::AuraRules{}.contact_margin_m, 1e-4);
  EXPECT_EQ(head_on_reach_m(AuraChoice::kNone, c), 0);
  EXPECT_GT(head_on_reach_m(AuraChoice::kSwept, c), 0.5);
}

}  // namespace
}  // namespace aurasim::lab
