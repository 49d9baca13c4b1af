#include "lab/summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "lab/thesis_tables.h"

namespace aurasim::lab {
namespace {

using core::SyncMode;
using Key = Tallies::Key;

bool is(const Key& key, AuraChoice aura) { return !key.variant.central && key.variant.aura == aura; }
bool is(const Key& key, AuraChoice aura, SyncMode sync) { return is(key, aura) && key.variant.sync == sync; }
/// True for auras that promise correct collisions here. Eq. 3.4 does not: it relies on both sides pulling, and does not
/// cover corners.
bool is_aura(const Key& key) {
  const bool promises = key.variant.aura != AuraChoice::kNone && key.variant.aura != AuraChoice::kThesis;
  return !key.variant.central && promises;
}

/// Smallest count of late and missed collisions of nodes without aura within tolerance, among the series.
std::uint64_t fewest_naive_errors(const Tallies& tallies) {
  std::map<std::string, std::uint64_t> errors;
  for (const auto& [key, tally] : tallies.entries()) {
    if (is(key, AuraChoice::kNone) && key.within && key.pairs == PairKind::kHeadOn) {
      errors[key.series] += tally.late + tally.missed;
    }
  }
  std::uint64_t fewest = errors.empty() ? 0 : ~std::uint64_t{0};
  for (const auto& [series, count] : errors) fewest = std::min(fewest, count);
  return fewest;
}

class TargetList {
 public:
  explicit TargetList(const Tallies& tallies) : tallies_(tallies) {}

  /// `measure` of the sum over `wanted` is at most `allowed`; left out where there were no trials.
  template <class Measure, class Wanted>
  void at_most(const std::string& name, double allowed, Measure&& measure, Wanted&& wanted) {
    const Tally sum = tallies_.sum(wanted);
    if (sum.trials > 0) targets_.push_back({name, static_cast<double>(measure(sum)), allowed});
  }
  void at_least(const std::string& name, double found, double allowed) {
    targets_.push_back({name, found, allowed, true});
  }
  std::vector<Target> take() { return std::move(targets_); }

 private:
  const Tallies& tallies_;
  std::vector<Target> targets_;
};

double late_percent(const Tally& t) { return t.percent(t.late); }
std::uint64_t wrong(const Tally& t) { return t.late + t.missed; }
std::uint64_t thrashed(const Tally& t) { return t.thrashed; }
std::uint64_t pulled_twice(const Tally& t) { return t.pulled_twice; }
std::uint64_t wrong_unwarned(const Tally& t) { return t.late_without_violation + t.missed_without_violation; }

/// The thesis's worst series of a factor bounds ours; with auras as large as its own, each series bounds its like.
void target_beyond(TargetList& list, const ThesisRow& row, double worst_percent) {
  const auto beyond = [&](AuraChoice aura) {
    return [&row, aura](const Key& k) {
      return is(k, aura, SyncMode::kFreeRunning) && !k.within && k.series == row.series && k.pairs == PairKind::kHeadOn;
    };
  };
  list.at_most(fmt::format("late %, swept, free_running, beyond {}", row.series), worst_percent, late_percent,
               beyond(AuraChoice::kSwept));
  list.at_most(fmt::format("late %, tight at the thesis's size, free_running, beyond {}", row.series), row.late_percent,
               late_percent, beyond(AuraChoice::kTightAtThesisSize));
}

}  // namespace

void Tallies::add(const Trial& trial) {
  const double value = trial.series == "loss" ? trial.value : -1;
  const auto same = [&](const Entry& e) {
    return e.key.within == trial.within && e.key.variant == trial.variant && e.key.value == value &&
           e.key.pairs == trial.pairs && e.key.series == trial.series;
  };
  auto found = std::find_if(entries_.rbegin(), entries_.rend(), same);
  if (found == entries_.rend()) {
    entries_.push_back({{trial.pairs, trial.series, trial.variant, trial.within, value}, {}});
    found = entries_.rbegin();
  }
  found->tally.add(trial);
}

std::vector<Target> collision_targets(const Tallies& tallies) {
  TargetList list(tallies);
  const auto swept = [](SyncMode sync) {
    return [sync](const Key& k) { return is(k, AuraChoice::kSwept, sync) && k.within; };
  };
  list.at_most("late and missed, swept, bounded, within tolerance", 0, wrong, swept(SyncMode::kBounded));
  list.at_most("late and missed without violation, swept, free_running, within tolerance", 0, wrong_unwarned,
               swept(SyncMode::kFreeRunning));
  list.at_most("late and missed, tight and swept, bounded, within tolerance", 0, wrong,
               [](const Key& k) { return is_aura(k) && k.variant.sync == SyncMode::kBounded && k.within; });
  list.at_most(
      "late and missed, swept, bounded, beyond tolerance in latency or frame time", 0, wrong,
      [](const Key& k) { return is(k, AuraChoice::kSwept, SyncMode::kBounded) && !k.within && k.series[0] != 's'; });
  list.at_most("thrashed, tight and swept, every mode, head-on", 0, thrashed,
               [](const Key& k) { return is_aura(k) && k.pairs == PairKind::kHeadOn; });
  list.at_most("thrashed, swept, bounded, every kind of pair", 0, thrashed,
               [](const Key& k) { return is(k, AuraChoice::kSwept, SyncMode::kBounded); });
  list.at_most("pulled more than once, tight and swept, every mode", 0, pulled_twice, is_aura);
  list.at_most("late or missed with no violation flagged, tight and swept, every mode, also beyond tolerance", 0,
               wrong_unwarned, is_aura);
  for (const ThesisRow& row : kThesisBeyond) {
    if (row.series[0] == 's') target_beyond(list, row, kThesisWorstBeyondSpeed);
    if (row.series[0] == 'f') target_beyond(list, row, kThesisWorstBeyondFrame);
  }
  const auto central = [](const Key& k) { return k.variant.central; };
  list.at_most(
      "late, control", 0, [](const Tally& t) { return t.late; }, central);
  list.at_most(
      "penetration time in steps, control", 1, [](const Tally& t) { return t.penetration_time_most_s / kStep_s; },
      central);
  list.at_most(
      "other bits than the control, swept, bounded, within tolerance", 0,
      [](const Tally& t) { return t.trials - t.same_bits; }, swept(SyncMode::kBounded));
  list.at_least("late and missed, none, within tolerance: fewest of the series", double(fewest_naive_errors(tallies)),
                1);
  return list.take();
}

std::vector<Target> loss_targets(const Tallies& tallies) {
  TargetList list(tallies);
  const auto at_15 = [](AuraChoice aura, SyncMode sync) {
    return [=](const Key& k) { return is(k, aura, sync) && std::abs(k.value - 15) < 0.01; };
  };
  list.at_most("late and missed, tight and swept, bounded, any loss", 0, wrong,
               [](const Key& k) { return is_aura(k) && k.variant.sync == SyncMode::kBounded; });
  for (const AuraChoice aura :
       {AuraChoice::kSwept, AuraChoice::kThesis, AuraChoice::kTight, AuraChoice::kTightAtThesisSize}) {
    list.at_most(fmt::format("late %, {}, free_running, 15% loss", name_of(aura)), kThesisLateAtFifteenPercentLoss / 2,
                 late_percent, at_15(aura, SyncMode::kFreeRunning));
  }
  list.at_most("thrashed, tight and swept, every mode", 0, thrashed, is_aura);
  list.at_most("late or missed with no violation flagged, tight and swept, every mode", 0, wrong_unwarned, is_aura);
  const Tally naive = tallies.sum(at_15(AuraChoice::kNone, SyncMode::kBounded));
  if (naive.trials > 0) list.at_least("late and missed, none, bounded, 15% loss", double(wrong(naive)), 1);
  return list.take();
}

}  // namespace aurasim::lab
