// Running, stopping and going on; the file in between.
#include "lab/campaign.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "lab/collision.h"
#include "lab/loss.h"
#include "lab/trial_file.h"

namespace aurasim::lab {
namespace {

class CampaignTest : public testing::Test {
 protected:
  CampaignTest() {
    directory_ =
        std::filesystem::temp_directory_path() / ("aurasim_campaign_" + std::to_string(::getpid()) + "_" +
                                                  testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(directory_);
    plan_.auras = {AuraChoice::kNone, AuraChoice::kSwept};
    plan_.syncs = {core::SyncMode::kBounded};
    plan_.pairs = {PairKind::kGrazing};
    plan_.repeats = 3;
    plan_.values_of_other_pairs = 1;
  }
  ~CampaignTest() override { std::filesystem::remove_all(directory_); }

  bool run(int threads = 1, std::size_t stop_after_jobs = 1000) {
    std::atomic<bool> stop = false;
    std::size_t jobs = 0;
    const bool finished = run_campaign(
        collision_campaign(plan_), directory_, run_job, threads,
        [&](const Progress& progress) {
          last_ = progress;
          if (++jobs >= stop_after_jobs) stop = true;
        },
        stop);
    jobs_run_ = jobs;
    return finished;
  }
  std::string file() const {
    std::ifstream in(directory_ / "collisions.csv");
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }

  std::filesystem::path directory_;
  CollisionPlan plan_;
  Progress last_;
  std::size_t jobs_run_ = 0;
};

TEST_F(CampaignTest, WritesARowForTheControlAndEachVariantOfEachPair) {
  EXPECT_TRUE(run());
  std::size_t rows = 0;
  read_trials(directory_ / "collisions.csv", [&](const Trial&) { ++rows; });
  EXPECT_EQ(rows, 9u * 3 * 3);
  EXPECT_DOUBLE_EQ(last_.share, 1);
}

TEST_F(CampaignTest, GoesOnWhereItStopped) {
  run();
  const std::string whole = file();
  std::filesystem::remove_all(directory_);
  EXPECT_FALSE(run(1, 4));
  EXPECT_LT(file().size(), whole.size());
  EXPECT_TRUE(run());
  EXPECT_EQ(jobs_run_, 5u);
  EXPECT_EQ(file(), whole);
}

TEST_F(CampaignTest, ARowThatWasCutOffIsRunAgain) {
  run();
  const std::string whole = file();
  std::filesystem::resize_file(directory_ / "collisions.csv", whole.size() - 30);
  EXPECT_TRUE(run());
  EXPECT_EQ(jobs_run_, 1u);
  EXPECT_EQ(file(), whole);
}

TEST_F(CampaignTest, IsTheSameOnAnyNumberOfThreads) {
  run(1);
  const std::string one = file();
  std::filesystem::remove_all(directory_);
  run(3);
  EXPECT_EQ(file(), one);
}

TEST_F(CampaignTest, AFolderWithOtherTrialsIsRefused) {
  run();
  plan_.repeats = 4;
  EXPECT_THROW(run(), std::runtime_error);
}

TEST_F(CampaignTest, HeadOnPairsTakeEveryValueOthersAFew) {
  plan_.pairs = {PairKind::kHeadOn, PairKind::kBoxes};
  EXPECT_EQ(collision_campaign(plan_).jobs.size(), 455u + 9u);
  plan_.pairs = {PairKind::kHeadOn};
  EXPECT_EQ(loss_campaign(plan_).jobs.size(), 21u);
}

TEST(TrialFile, ARowReadIsTheRowWritten) {
  Trial trial;
  trial.pairs = PairKind::kCapsules;
  trial.series = "latency_2ms";
  trial.tolerance = 2;
  trial.value = 0.05;
  trial.within = true;
  trial.variant = {AuraChoice::kTightAtThesisSize, core::SyncMode::kFreeRunning, false};
  trial.repeat = 7;
  trial.contact = Contact{41, 0.1 + 0.2, 63.999999999999};
  trial.central_step = 40;
  trial.hand_offs = 2;
  trial.pulls = 1;
  trial.violations = 3;
  trial.flagged = true;
  trial.slow_down = 1.25;
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("aurasim_trial_" + std::to_string(::getpid()) + ".csv");
  std::ofstream(file) << trial_header() << trial_row(trial);
  std::vector<Trial> read;
  read_trials(file, [&](const Trial& t) { read.push_back(t); });
  std::filesystem::remove(file);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(trial_row(read[0]), trial_row(trial));
  EXPECT_EQ(read[0].contact, trial.contact) << "to the last bit";
  EXPECT_EQ(read[0].central_step, trial.central_step);
  EXPECT_EQ(read[0].variant, trial.variant);
}

}  // namespace
}  // namespace aurasim::lab
