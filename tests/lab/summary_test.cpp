// Sums and requirements.
#include "lab/summary.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <unistd.h>

#include "lab/collision.h"

namespace aurasim::lab {
namespace {

using core::SyncMode;

Trial trial(const Variant& variant, bool within, double penetration_m, const std::string& series = "speed_32m_s") {
  Trial t;
  t.series = series;
  t.variant = variant;
  t.within = within;
  t.contact = Contact{10, penetration_m, 60};
  t.central_step = 10;
  t.same_bits = true;
  return t;
}

const Target& target(const std::vector<Target>& targets, const std::string& beginning) {
  for (const Target& t : targets) {
    if (t.name.rfind(beginning, 0) == 0) return t;
  }
  throw std::out_of_range(beginning);
}

constexpr Variant kSweptBounded = {AuraChoice::kSwept, SyncMode::kBounded, false};
constexpr Variant kSweptFree = {AuraChoice::kSwept, SyncMode::kFreeRunning, false};
constexpr Variant kNaive = {AuraChoice::kNone, SyncMode::kBounded, false};
constexpr double kLatePenetration_m = 2;

TEST(Summary, ALateCollisionWithinToleranceMissesTheTarget) {
  Tallies tallies;
  tallies.add(trial(kSweptBounded, true, 0.5));
  EXPECT_TRUE(target(collision_targets(tallies), "late and missed, swept, bounded, within").met());
  tallies.add(trial(kSweptBounded, true, kLatePenetration_m));
  EXPECT_FALSE(target(collision_targets(tallies), "late and missed, swept, bounded, within").met());
}

TEST(Summary, FreeRunningMayBeLateOnlyWithAWarning) {
  Tallies tallies;
  Trial warned = trial(kSweptFree, true, kLatePenetration_m);
  warned.flagged = true;
  warned.violations = 1;
  tallies.add(warned);
  EXPECT_TRUE(target(collision_targets(tallies), "late and missed without violation, swept").met());
  EXPECT_TRUE(target(collision_targets(tallies), "late or missed with no violation flagged").met());
  tallies.add(trial(kSweptFree, true, kLatePenetration_m));
  EXPECT_FALSE(target(collision_targets(tallies), "late and missed without violation, swept").met());
  EXPECT_FALSE(target(collision_targets(tallies), "late or missed with no violation flagged").met());
}

TEST(Summary, TheNaiveControlHasToFailInEverySeries) {
  Tallies tallies;
  tallies.add(trial(kNaive, true, kLatePenetration_m, "speed_16m_s"));
  EXPECT_TRUE(target(collision_targets(tallies), "late and missed, none").met());
  tallies.add(trial(kNaive, true, 0.1, "speed_32m_s"));
  EXPECT_FALSE(target(collision_targets(tallies), "late and missed, none").met());
}

TEST(Summary, LateBeyondToleranceIsComparedWithTheThesis) {
  Tallies tallies;
  tallies.add(trial(kSweptFree, false, 0.5));
  tallies.add(trial(kSweptFree, false, 0.5));
  tallies.add(trial(kSweptFree, false, kLatePenetration_m));
  const std::vector<Target> targets = collision_targets(tallies);
  const Target& t = target(targets, "late %, swept, free_running, beyond speed_32m_s");
  EXPECT_NEAR(t.found, 100.0 / 3, 1e-9);
  EXPECT_NEAR(t.allowed, 49.9, 1e-9);
}

/// A small grid of the real thing.
TEST(Summary, SweptIsNeverLateAndNoneIsInASmallGrid) {
  CollisionPlan plan;
  plan.pairs = {PairKind::kHeadOn};
  plan.auras = {AuraChoice::kNone, AuraChoice::kSwept};
  plan.syncs = {SyncMode::kFreeRunning, SyncMode::kBounded};
  Campaign campaign = collision_campaign(plan);
  campaign.repeats = 8;
  campaign.jobs.clear();
  for (const Series& series : thesis_series()) add_jobs(campaign, PairKind::kHeadOn, thinned(series, 4));
  Tallies tallies;
  for (const Job& job : campaign.jobs) {
    for (const Trial& t : run_job(campaign, job)) tallies.add(t);
  }
  const std::vector<Target> targets = collision_targets(tallies);
  EXPECT_TRUE(target(targets, "late and missed, swept, bounded, within").met());
  EXPECT_TRUE(target(targets, "late and missed without violation, swept, free_running").met());
  EXPECT_TRUE(target(targets, "late or missed with no violation flagged").met());
  EXPECT_TRUE(target(targets, "thrashed, tight and swept, every mode, head-on").met());
  EXPECT_TRUE(target(targets, "penetration time in steps, control").met());
  EXPECT_TRUE(target(targets, "other bits than the control, swept").met());
  EXPECT_TRUE(target(targets, "late and missed, none").met()) << "a check that cannot fail";
}

}  // namespace
}  // namespace aurasim::lab
