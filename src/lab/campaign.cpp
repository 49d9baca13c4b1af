#include "lab/campaign.h"

#include <chrono>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/fnv1a.h"
#include "lab/on_threads.h"
#include "lab/trial.h"
#include "lab/trial_file.h"

namespace aurasim::lab {
namespace {

using Clock = std::chrono::steady_clock;

/// Seed of a job's pair. It depends on the job's contents, not on its place in the list.
std::uint64_t seed_of(const Campaign& campaign, const Job& job, std::uint32_t repeat) {
  core::Fnv1a hash;
  hash.add_text(fmt::format("{} {} {} {} {}", campaign.seed, name_of(job.pairs), name_of(job.series),
                            shown(job.series.factor, job.value), repeat));
  return hash.value();
}

/// Estimated work of a job, from the steps until the meeting: slow bodies need many.
double work_of(const Campaign& campaign, const Job& job) {
  Chance chance(1);
  return 30.0 +
         static_cast<double>(
             make_pair(job.pairs, conditions_at(job.series, job.value, campaign.substeps), chance).expected_step);
}

/// Description that two runs must share to add to the same file.
std::string described(const Campaign& campaign) {
  nlohmann::json variants = nlohmann::json::array();
  for (const Variant& v : campaign.variants) variants.push_back(fmt::format("{} {}", name_of(v.aura), name_of(v.sync)));
  nlohmann::json jobs = nlohmann::json::array();
  for (const Job& job : campaign.jobs) {
    jobs.push_back(
        fmt::format("{} {} {}", name_of(job.pairs), name_of(job.series), shown(job.series.factor, job.value)));
  }
  const nlohmann::json all = {{"experiment", campaign.name},
                              {"over_dds", campaign.over_dds},
                              {"repeats", campaign.repeats},
                              {"seed", campaign.seed},
                              {"substeps", campaign.substeps},
                              {"variants", variants},
                              {"jobs", jobs}};
  return all.dump(1) + "\n";
}

void agree_with(const Campaign& campaign, const std::filesystem::path& directory) {
  std::filesystem::create_directories(directory);
  const std::filesystem::path file = directory / "campaign.json";
  const std::string wanted = described(campaign);
  std::ifstream in(file);
  std::stringstream found;
  found << in.rdbuf();
  if (in.is_open() && found.str() != wanted) {
    throw std::runtime_error(
        fmt::format("{} holds trials of another experiment (campaign.json differs); choose another --out or remove it",
                    directory.string()));
  }
  std::ofstream(file) << wanted;
}

/// Hands jobs to threads, collects their rows, and writes them in order.
class JobQueue {
 public:
  JobQueue(const Campaign& campaign, const std::filesystem::path& file, std::size_t done,
           const std::function<void(const Progress&)>& show)
      : out_(file, std::ios::app), next_(done), written_(done), begin_(Clock::now()), show_(show) {
    for (const Job& job : campaign.jobs) work_.push_back(work_of(campaign, job));
    for (std::size_t i = 0; i < work_.size(); ++i) (i < done ? done_before_ : to_do_) += work_[i];
  }

  std::size_t take() {
    const std::lock_guard lock(mutex_);
    return next_++;
  }

  void give(std::size_t job, std::string rows) {
    const std::lock_guard lock(mutex_);
    finished_.emplace(job, std::move(rows));
    done_now_ += work_[job];
    for (auto at = finished_.begin(); at != finished_.end() && at->first == written_; at = finished_.erase(at)) {
      out_ << at->second;
      ++written_;
    }
    out_.flush();
    if (!out_) throw std::runtime_error("cannot write collisions.csv");
    const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
    show_({(done_before_ + done_now_) / (done_before_ + to_do_), elapsed, elapsed * (to_do_ - done_now_) / done_now_});
  }

 private:
  std::mutex mutex_;
  std::ofstream out_;
  std::size_t next_;
  std::size_t written_;
  std::map<std::size_t, std::string> finished_;  ///< rows that wait for those of earlier jobs
  std::vector<double> work_;
  double done_before_ = 0, to_do_ = 0, done_now_ = 0;
  Clock::time_point begin_;
  const std::function<void(const Progress&)>& show_;
};

void work(const Campaign& campaign, const JobRunner& run, JobQueue& jobs, const std::atomic<bool>& stop) {
  while (!stop) {
    const std::size_t i = jobs.take();
    if (i >= campaign.jobs.size()) return;
    std::string rows;
    for (const Trial& trial : run(campaign, campaign.jobs[i])) rows += trial_row(trial);
    jobs.give(i, std::move(rows));
  }
}

}  // namespace

std::vector<Variant> all_variants(const std::vector<AuraChoice>& auras, const std::vector<core::SyncMode>& syncs) {
  std::vector<Variant> variants;
  for (const AuraChoice aura : auras) {
    for (const core::SyncMode sync : syncs) variants.push_back({aura, sync, false});
  }
  return variants;
}

void add_jobs(Campaign& campaign, PairKind pairs, const Series& series) {
  for (const double value : series.values) campaign.jobs.push_back({pairs, series, value});
}

Draw draw_pair(const Campaign& campaign, const Job& job, std::uint32_t repeat, double aside_m) {
  const Conditions conditions = conditions_at(job.series, job.value, campaign.substeps);
  Chance chance(seed_of(campaign, job, repeat));
  Draw draw;
  draw.pair = make_pair(job.pairs, conditions, chance);
  draw.disorder = make_disorder(conditions, chance);
  for (core::InitialBody& body : draw.pair.scene.bodies) body.pose.p_WB.y() += aside_m;
  return draw;
}

Trial control_of(const Draw& draw, const Conditions& conditions) {
  Trial control;
  control.contact = run_central(draw.pair, conditions);
  control.same_bits = true;
  if (control.contact) control.central_step = control.contact->step;
  return control;
}

Trial labelled(Trial trial, const Job& job, const Variant& variant, std::uint32_t repeat) {
  trial.pairs = job.pairs;
  trial.series = name_of(job.series);
  trial.tolerance = shown(job.series.factor, job.series.tolerance);
  trial.value = shown(job.series.factor, job.value);
  trial.within = within_tolerance(job.series, job.value);
  trial.variant = variant;
  trial.repeat = repeat;
  return trial;
}

std::vector<Trial> run_job(const Campaign& campaign, const Job& job) {
  const Conditions conditions = conditions_at(job.series, job.value, campaign.substeps);
  std::vector<Trial> trials;
  for (std::uint32_t repeat = 0; repeat < campaign.repeats; ++repeat) {
    const Draw draw = draw_pair(campaign, job, repeat);
    const Trial control = control_of(draw, conditions);
    trials.push_back(labelled(control, job, kControl, repeat));
    for (const Variant& variant : campaign.variants) {
      const Trial trial = run_pair(draw.pair, conditions, variant, draw.disorder, control.contact);
      trials.push_back(labelled(trial, job, variant, repeat));
    }
  }
  return trials;
}

bool run_campaign(const Campaign& campaign, const std::filesystem::path& directory, const JobRunner& run, int threads,
                  const std::function<void(const Progress&)>& show, const std::atomic<bool>& stop) {
  agree_with(campaign, directory);
  const std::filesystem::path file = directory / "collisions.csv";
  const std::size_t done = keep_whole_blocks(file, campaign.rows_per_job());
  JobQueue jobs(campaign, file, done, show);
  on_threads(threads, [&] { work(campaign, run, jobs, stop); });
  return !stop;
}

}  // namespace aurasim::lab
