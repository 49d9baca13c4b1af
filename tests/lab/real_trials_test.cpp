// Trials over DDS, in real time.
#include "lab/real_trials.h"

#include <gtest/gtest.h>

#include "config/shipped_files.h"
#include "lab/collision.h"
#include "own_domain.h"

namespace aurasim::lab {
namespace {

/// By variant; the control is not among them.
std::array<Tally, 2> try_over_dds(PairKind kind, const Series& series, std::uint32_t repeats) {
  Campaign campaign;
  campaign.repeats = repeats;
  campaign.variants = {{AuraChoice::kSwept, core::SyncMode::kBounded, false},
                       {AuraChoice::kNone, core::SyncMode::kBounded, false}};
  RealLaboratory laboratory(test::own_domain(), config::shipped_profiles());
  std::array<Tally, 2> tallies;
  for (const Trial& trial : laboratory.run_job(campaign, {kind, series, series.tolerance})) {
    for (std::size_t i = 0; i < 2; ++i) {
      if (trial.variant == campaign.variants[i]) tallies[i].add(trial);
    }
  }
  return tallies;
}

TEST(RealTrials, PairsSideBySideMeetAsInOneWorldToTheLastBitAndNotWithoutAuras) {
  const auto [swept, none] = try_over_dds(PairKind::kHeadOn, thesis_series()[5], 10);  // 16 ms of latency
  EXPECT_EQ(swept.trials, 10U);
  EXPECT_EQ(swept.same_bits, swept.trials);
  EXPECT_EQ(swept.late + swept.missed + swept.thrashed, 0U);
  EXPECT_GT(none.late + none.missed, 0U);
}

TEST(RealTrials, FourNodesMeetInACorner) {
  const auto [swept, none] = try_over_dds(PairKind::kCorner, thesis_series()[1], 3);
  EXPECT_EQ(swept.trials, 3U);
  EXPECT_EQ(swept.same_bits, swept.trials);
  EXPECT_EQ(none.trials, 3U);
}

}  // namespace
}  // namespace aurasim::lab
