// All trials of an experiment: lists them, runs them on a few threads, and goes on where an earlier run stopped.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lab/metrics.h"
#include "lab/trial.h"

namespace aurasim::lab {

/// One value of one series and kind of pairs: `repeats` pairs, each under the control and every variant.
struct Job {
  PairKind pairs{};
  Series series;
  double value = 0;
};

struct Campaign {
  std::string name;       ///< "collision" or "loss"
  bool over_dds = false;  ///< in real time; otherwise in virtual time
  std::vector<Job> jobs;
  std::vector<Variant> variants;
  std::uint32_t repeats = 50;
  std::uint64_t seed = 1;
  int substeps = 1;

  std::size_t rows_per_job() const { return repeats * (variants.size() + 1); }
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

struct Progress {
  double share = 0;  ///< share of the work done, 0 to 1
  double elapsed_s = 0;
  double left_s = 0;
};

/// Runs the trials that DIR/collisions.csv lacks and appends them. Throws std::runtime_error when DIR holds another
/// campaign. Returns false when `stop` became true before the end. `run` is called on `threads` threads.
bool run_campaign(const Campaign& campaign, const std::filesystem::path& directory, const JobRunner& run, int threads,
                  const std::function<void(const Progress&)>& show, const std::atomic<bool>& stop);

}  // namespace aurasim::lab
