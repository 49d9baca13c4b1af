// The experiments collision and loss, in virtual time and over DDS, as rows of results.
#include <map>
#include <utility>

#include <fmt/format.h>

#include "config/shipped_files.h"
#include "lab/aura_radius.h"
#include "lab/collision.h"
#include "lab/real_trials.h"
#include "lab/suites/suites.h"
#include "lab/thesis_tables.h"

namespace aurasim::lab {
namespace {

/// Share of the time that the collision experiment takes of both.
constexpr double kCollisionShare = 0.9;
constexpr const char* kLoss = "loss";  ///< the part of the suites beside the kinds of pairs
constexpr int kThreads = 2;
constexpr std::uint32_t kDomain = 61;  ///< of DDS, for trials in real time

/// Trials of one cell of a table; `late` and so on are those of Tally.
using Cells = std::map<std::string, Tally>;

struct Trials {
  Tallies tallies;
  Cells by_series;  ///< head-on pairs: "within/speed, 32 m per s/swept, bounded"
  Cells by_pairs;   ///< "pairs/corner/swept, bounded, within"
  Cells by_loss;    ///< "loss/15%/swept, bounded"
  Cells by_value;   ///< head-on pairs of two series: "late by speed, 32 m per s/40/swept, free_running"
};

/// Without a slash, which divides the parts of a case.
std::string unit_of(const std::string& series) { return series[0] == 's' ? "m per s" : "ms"; }

std::string title_of(const Trial& trial) {
  const std::string factor = trial.series.substr(0, trial.series.find('_'));
  return fmt::format("{}, {:g} {}", factor, trial.tolerance, unit_of(trial.series));
}

std::string title_of(const Variant& variant) {
  if (variant.central) return "control";
  std::string aura(name_of(variant.aura));
  if (variant.aura == AuraChoice::kTightAtThesisSize) aura = "tight at the thesis's size";
  return fmt::format("{}, {}", aura, core::name_of(variant.sync));
}

void add(const Trial& trial, Trials& all) {
  all.tallies.add(trial);
  const std::string variant = title_of(trial.variant);
  const char* kept = trial.within ? "within" : "beyond";
  if (trial.series == "loss") {
    all.by_loss[fmt::format("loss/{:02g}%/{}", trial.value, variant)].add(trial);
    return;
  }
  if (!trial.variant.central) {
    all.by_pairs[fmt::format("pairs/{}/{}, {}", name_of(trial.pairs), variant, kept)].add(trial);
  }
  if (trial.pairs != PairKind::kHeadOn || trial.variant.central) return;
  all.by_series[fmt::format("{}/{}/{}", kept, title_of(trial), variant)].add(trial);
  const bool is_shown =
      trial.variant.sync == core::SyncMode::kFreeRunning && trial.variant.aura != AuraChoice::kTightAtThesisSize;
  if (is_shown && (trial.series == "speed_32m_s" || trial.series == "frame_15ms")) {
    all.by_value[fmt::format("late by {}/{:g}/{}", title_of(trial), trial.value, variant)].add(trial);
  }
}

/// Runs campaigns and adds up their trials.
struct Runner {
  JobRunner run_job;
  int threads = 1;
  const Progress& progress;

  /// Runs a campaign to its end, which is `part` of the work after the share `before`. False if it was stopped.
  bool run(const Campaign& campaign, double before, double part, Trials& all) const {
    return run_campaign(
        campaign, run_job, threads, [&](double share) { return progress(before + part * share); },
        [&](const Trial& trial) { add(trial, all); });
  }
};

class Rows {
 public:
  explicit Rows(std::vector<ResultRow>& out) : out_(out) {}

  void count(const std::string& what, const char* metric, std::uint64_t found, const Tally& of) {
    out_.push_back({what, metric, static_cast<double>(found), "1", static_cast<int>(of.trials)});
  }
  void percent(const std::string& what, const char* metric, std::uint64_t found, const Tally& of) {
    out_.push_back({what, metric, of.percent(found), "%", static_cast<int>(of.trials)});
  }
  void value(const std::string& what, const char* metric, double found, const char* unit) {
    out_.push_back({what, metric, found, unit});
  }

 private:
  std::vector<ResultRow>& out_;
};

void add_rows(const Trials& all, std::vector<ResultRow>& out) {
  Rows rows(out);
  for (const auto& [what, tally] : all.by_series) {
    rows.percent(what, "late", tally.late, tally);
    rows.percent(what, "missed", tally.missed, tally);
  }
  for (const auto& [what, tally] : all.by_pairs) {
    rows.count(what, "pairs", tally.trials, tally);
    rows.count(what, "late", tally.late, tally);
    rows.count(what, "missed", tally.missed, tally);
    rows.count(what, "thrashed", tally.thrashed, tally);
    rows.count(what, "wrong, not flagged", tally.late_without_violation + tally.missed_without_violation, tally);
    rows.count(what, "other bits than the control", tally.trials - tally.same_bits, tally);
  }
  for (const auto& [what, tally] : all.by_loss) {
    rows.percent(what, "late", tally.late, tally);
    rows.percent(what, "missed", tally.missed, tally);
    rows.value(what, "time taken over simulated", tally.mean_slow_down(), "1");
  }
  for (const auto& [what, tally] : all.by_value) rows.percent(what, "late", tally.late, tally);
}

void add_thesis(std::vector<ResultRow>& out) {
  Rows rows(out);
  for (const auto& [kept, table] : {std::pair{"within", kThesisWithin}, std::pair{"beyond", kThesisBeyond}}) {
    const std::vector<Series> series = thesis_series();
    for (std::size_t i = 0; i < table.size(); ++i) {
      Trial named;
      named.series = name_of(series[i]);
      named.tolerance = shown(series[i].factor, series[i].tolerance);
      const std::string what = fmt::format("{}/{}/published", kept, title_of(named));
      rows.value(what, "late", table[i].late_percent, "%");
      rows.value(what, "missed", table[i].missed_percent, "%");
    }
  }
}

void add_aura_sizes(std::vector<ResultRow>& out) {
  Rows rows(out);
  for (const Series& series : thesis_series()) {
    const Conditions c = conditions_at(series, series.tolerance, 1);
    Trial named;
    named.series = name_of(series);
    named.tolerance = shown(series.factor, series.tolerance);
    const std::string what = "aura size/" + title_of(named);
    rows.value(what, "K", lookahead(c.promised), "1");
    rows.value(what, "thesis", aura_reach_m(AuraChoice::kThesis, c), "m");
    rows.value(what, "tight", aura_reach_m(AuraChoice::kTight, c), "m");
    rows.value(what, "swept, head on at top speed", head_on_reach_m(AuraChoice::kSwept, c), "m");
  }
}

CollisionPlan full_plan() {
  CollisionPlan plan;
  plan.pairs.assign(kPairKinds.begin(), kPairKinds.end());
  plan.auras = {AuraChoice::kNone, AuraChoice::kThesis, AuraChoice::kTight, AuraChoice::kTightAtThesisSize,
                AuraChoice::kSwept};
  plan.syncs = {core::SyncMode::kFreeRunning, core::SyncMode::kBounded};
  return plan;
}

void add_loss(const Trials& loss, SuiteResults& results) {
  add_rows(loss, results.rows);
  SuiteResults of_loss;
  add_targets(of_loss, loss_targets(loss.tallies));
  for (ResultRow& row : of_loss.rows) results.rows.push_back({"loss, " + row.what, row.metric, row.value, row.unit});
  results.targets.insert(results.targets.end(), of_loss.targets.begin(), of_loss.targets.end());
}

}  // namespace

std::vector<std::string> correctness_parts() {
  std::vector<std::string> parts;
  for (const PairKind kind : kPairKinds) parts.emplace_back(name_of(kind));
  parts.emplace_back(kLoss);
  return parts;
}

SuiteResults run_correctness_suite(const SuitePlan& wanted, const Progress& progress) {
  CollisionPlan plan = full_plan();
  if (!wanted.is_full() && wanted.only.empty()) plan.pairs = {PairKind::kCorner};
  std::erase_if(plan.pairs, [&](PairKind kind) { return !wanted.wants(std::string(name_of(kind))); });
  const Runner runner{run_job, kThreads, progress};
  const bool has_loss = wanted.only.empty() ? wanted.is_full() : wanted.wants(kLoss);
  SuiteResults results;
  Trials collision, loss;
  if (!plan.pairs.empty()) {
    if (!runner.run(collision_campaign(plan), 0, kCollisionShare, collision)) return results;
    add_rows(collision, results.rows);
    add_aura_sizes(results.rows);
  }
  if (wanted.is_full() && wanted.only.empty()) {  // a sum over a part of the pairs is no sum of the stored run
    add_thesis(results.rows);
    add_targets(results, collision_targets(collision.tallies));
  }
  if (!has_loss) return results;
  if (!runner.run(loss_campaign(plan), kCollisionShare, 1 - kCollisionShare, loss)) return results;
  add_loss(loss, results);
  return results;
}

std::vector<std::string> correctness_over_dds_parts() { return {std::string(name_of(PairKind::kHeadOn)), kLoss}; }

SuiteResults run_correctness_over_dds_suite(const SuitePlan& wanted, const Progress& progress) {
  CollisionPlan plan = full_plan();
  plan.pairs = {PairKind::kHeadOn};
  plan.auras = {AuraChoice::kNone, AuraChoice::kTight, AuraChoice::kSwept};
  plan.repeats = 20;
  plan.values_of_head_on_pairs = 4;
  const bool has_pairs = wanted.only.empty() ? wanted.is_full() : wanted.wants(correctness_over_dds_parts().front());
  RealLaboratory laboratory(kDomain, config::shipped_profiles());
  const Runner runner{[&](const Campaign& all, const Job& job) { return laboratory.run_job(all, job); }, 1, progress};
  const double share = has_pairs ? kCollisionShare : 0;
  SuiteResults results;
  Trials collision, loss;
  if (has_pairs) {
    if (!runner.run(collision_campaign(plan), 0, share, collision)) return results;
    add_rows(collision, results.rows);
    add_targets(results, collision_targets(collision.tallies));
  }
  if (!wanted.wants(kLoss)) return results;
  plan.values_of_head_on_pairs = 5;
  if (!runner.run(loss_campaign(plan), share, 1 - share, loss)) return results;
  add_loss(loss, results);
  if (!wanted.is_full()) results.rows.clear();  // trials in real time scatter: only the requirements are checked
  return results;
}

}  // namespace aurasim::lab
