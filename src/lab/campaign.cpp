#include "lab/campaign.h"

#include <map>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "core/fnv1a.h"
#include "lab/trial.h"

namespace aurasim::lab {
namespace {

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

bool run_campaign(const Campaign& campaign, const JobRunner& run, int threads, const Progress& progress,
                  const std::function<void(const Trial&)>& take) {
  std::vector<double> costs;
  for (const Job& job : campaign.jobs) costs.push_back(work_of(campaign, job));
  std::mutex mutex;
  std::map<std::size_t, std::vector<Trial>> waiting;  // for those of earlier jobs
  std::size_t next = 0;
  return on_threads(threads, costs, progress, [&](const WorkPiece& piece) {
    std::vector<Trial> trials = run(campaign, campaign.jobs[piece.index]);
    const std::lock_guard lock(mutex);
    waiting.emplace(piece.index, std::move(trials));
    for (auto at = waiting.begin(); at != waiting.end() && at->first == next; at = waiting.erase(at), ++next) {
      for (const Trial& trial : at->second) take(trial);
    }
  });
}

}  // namespace aurasim::lab
