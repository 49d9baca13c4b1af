// All trials of an experiment: lists them, and runs them on a few threads.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lab/metrics.h"
#include "lab/on_threads.h"
#include "lab/trial.h"

namespace aurasim::lab {

/// One value of one series and kind of pairs: `repeats` pairs, each under the control and every variant.
struct Job {
  PairKind pairs{};
  Series series;
  double value = 0;
};

struct Campaign {
  std::vector<Job> jobs;
  std::vector<Variant> variants;
  std::uint32_t repeats = 50;
  std::uint64_t seed = 1;
  int substeps = 1;
};

/// Each aura with each way to wait.
std::vector<Variant> all_variants(const std::vector<AuraChoice>& auras, const std::vector<core::SyncMode>& syncs);

void add_jobs(Campaign& campaign, PairKind pairs, const Series& series);

/// One pair of a job, and the other random settings of its trials.
struct Draw {
  Pair pair;
  Disorder disorder;
};
/// Draws a pair. The result is the same for the same campaign, job and repeat. `aside_m`: distance in metres by which
/// the pair is moved along y.
Draw draw_pair(const Campaign& campaign, const Job& job, std::uint32_t repeat, double aside_m = 0);
/// The trial of the pair in one world.
Trial control_of(const Draw& draw, const Conditions& conditions);
inline constexpr Variant kControl = {AuraChoice::kNone, core::SyncMode::kBounded, true};
/// The trial with the job, variant and repeat that it belongs to.
Trial labelled(Trial trial, const Job& job, const Variant& variant, std::uint32_t repeat);

/// Runs a job in virtual time. The same job of the same campaign gives the same trials, in any order and on any thread.
std::vector<Trial> run_job(const Campaign& campaign, const Job& job);
using JobRunner = std::function<std::vector<Trial>(const Campaign&, const Job&)>;

/// Runs the trials on `threads` threads, and calls `take` with each, in the order of the jobs. Returns false if
/// `progress` ended it early.
bool run_campaign(const Campaign& campaign, const JobRunner& run, int threads, const Progress& progress,
                  const std::function<void(const Trial&)>& take);

}  // namespace aurasim::lab
