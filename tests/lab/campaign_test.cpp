// Running all trials of an experiment, and stopping.
#include "lab/campaign.h"

#include <gtest/gtest.h>

#include "lab/collision.h"

namespace aurasim::lab {
namespace {

class CampaignTest : public testing::Test {
 protected:
  CampaignTest() {
    plan_.auras = {AuraChoice::kNone, AuraChoice::kSwept};
    plan_.syncs = {core::SyncMode::kBounded};
    plan_.pairs = {PairKind::kGrazing};
    plan_.repeats = 3;
    plan_.values_of_other_pairs = 1;
  }

  bool run(int threads = 1, std::size_t stop_after_jobs = 1000) {
    std::size_t jobs = 0;
    trials_.clear();
    return run_campaign(
        collision_campaign(plan_), run_job, threads,
        [&](double share) {
          last_share_ = share;
          return ++jobs < stop_after_jobs;
        },
        [&](const Trial& trial) { trials_.push_back(trial); });
  }

  CollisionPlan plan_;
  double last_share_ = 0;
  std::vector<Trial> trials_;
};

TEST_F(CampaignTest, HasATrialForTheControlAndEachVariantOfEachPair) {
  EXPECT_TRUE(run());
  EXPECT_EQ(trials_.size(), 9u * 3 * 3);
  EXPECT_DOUBLE_EQ(last_share_, 1);
}

TEST_F(CampaignTest, EndsEarlyWhenItIsTold) {
  EXPECT_FALSE(run(1, 4));
  EXPECT_EQ(trials_.size(), 4u * 3 * 3);
  EXPECT_LT(last_share_, 1);
}

TEST_F(CampaignTest, IsTheSameOnAnyNumberOfThreads) {
  run(1);
  const std::vector<Trial> one = trials_;
  run(3);
  EXPECT_EQ(trials_, one);
}

TEST_F(CampaignTest, HeadOnPairsTakeEveryValueOthersAFew) {
  plan_.pairs = {PairKind::kHeadOn, PairKind::kBoxes};
  EXPECT_EQ(collision_campaign(plan_).jobs.size(), 455u + 9u);
  EXPECT_EQ(loss_campaign(plan_).jobs.size(), 21u);
}

}  // namespace
}  // namespace aurasim::lab
