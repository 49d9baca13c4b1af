#include "lab/scenes/deaths.h"

#include <algorithm>
#include <map>
#include <random>
#include <utility>

namespace aurasim::lab {
namespace {

constexpr core::Step kBetweenCheckpoints = 60;

/// A coupled node that dies in the middle of a state has posted fewer parcels in it.
constexpr std::uint64_t kMostParcels = 100;

/// The part of a run between two deaths.
class Life {
 public:
  Life(VirtualCluster& cluster, const Disasters& disasters, int lookahead, const core::WorldCut* world)
      : cluster_(cluster), lookahead_(lookahead), world_(world), recorded_(cluster.size(), -1) {
    played_.hash.assign(static_cast<std::size_t>(disasters.steps) + 1, 0);
    const core::Step begin = world != nullptr ? world->step : 0;
    for (core::Step n = begin + kBetweenCheckpoints; n < disasters.steps; n += kBetweenCheckpoints) {
      for (std::size_t r = 0; r < cluster.size(); ++r) cluster.node(r).save(n);
    }
    for (std::size_t r = 0; r < cluster.size(); ++r) record(r);
  }

  /// Runs until `victim` has computed state `last`. False when `stop` became true.
  bool run(Interference& interference, std::size_t victim, core::Step last, const std::atomic<bool>& stop) {
    ImpatientClient client(interference.requests);
    Programs programs(interference.words, cluster_, world_ != nullptr ? world_->step : 0);
    if (world_ != nullptr) client.speak_after(*world_, cluster_.node(0));
    while (cluster_.node(victim).current_step() < last) {
      if (stop) return false;
      if (world_ == nullptr) client.speak(cluster_.node(0));
      programs.speak();
      const VirtualCluster::Event event = cluster_.next();
      const std::size_t r = core::value_of(event.region);
      for (core::WorldCut& part : cluster_.node(r).take_saved()) {
        parts_[part.step].push_back(through_a_file(std::move(part)));
      }
      record(r);
      note_redo(event, played_);
    }
    return true;
  }

  /// The world in the newest complete state, with the orders that the survivors know by now. Nothing if there is none.
  std::optional<core::WorldCut> saved(std::size_t victim) {
    const core::Step recorded = *std::ranges::min_element(recorded_);
    for (auto part = parts_.rbegin(); part != parts_.rend(); ++part) {
      auto& [step, parts] = *part;
      if (parts.size() < cluster_.size() || recorded < step + lookahead_) continue;
      const core::WorldCut whole = core::merge(parts);
      for (std::size_t r = 0; r < cluster_.size(); ++r) {
        if (r != victim) parts.push_back(cluster_.node(r).orders_now(whole));
      }
      return core::merge(std::move(parts));
    }
    return std::nullopt;
  }

  const Played& played() const { return played_; }

 private:
  void record(std::size_t r) {
    for (const node::StepReport& report : cluster_.node(r).confirmed()) {
      note_report(report, played_);
      recorded_[r] = std::max(recorded_[r], report.step);
    }
  }

  VirtualCluster& cluster_;
  int lookahead_;
  const core::WorldCut* world_;
  Played played_;
  std::vector<core::Step> recorded_;  ///< by region
  std::map<core::Step, std::vector<core::WorldCut>> parts_;
};

/// Copies the results of the states after `from`, up to `until`.
void take_over(const Played& part, core::Step from, core::Step until, Played& whole) {
  const auto at = [](core::Step step) { return static_cast<std::ptrdiff_t>(step + 1); };
  std::copy(part.hash.begin() + at(from), part.hash.begin() + at(until), whole.hash.begin() + at(from));
  whole.hand_offs += part.hand_offs;
  whole.largest_cluster = std::max(whole.largest_cluster, part.largest_cluster);
  whole.redos += part.redos;
  whole.again += part.again;
}

}  // namespace

std::optional<Played> play_with_deaths(const Disasters& disasters, const config::Launch& launch,
                                       const ClusterRules& rules, Interference& interference,
                                       const std::atomic<bool>& stop, std::optional<VirtualCluster>& cluster) {
  std::mt19937_64 random(disasters.seed);
  Played whole;
  whole.hash.assign(static_cast<std::size_t>(disasters.steps) + 1, 0);
  const double begin_s = thread_time_s();
  std::optional<core::WorldCut> world;
  core::Step from = -1;
  const auto bring_up = [&] {
    const node::Recorded recorded = world ? node::Recorded::kYes : node::Recorded::kNo;
    cluster.emplace(launch.scene, launch.regions, rules, world ? &*world : nullptr, recorded);
  };
  for (int death = 0; death < disasters.deaths; ++death) {
    bring_up();
    const std::size_t victim = random() % cluster->size();
    const core::Step first = std::max<core::Step>(from, 0) + 1;
    const core::Step last =
        first + static_cast<core::Step>(random() % static_cast<std::uint64_t>(disasters.steps - first + 1));
    Life life(*cluster, disasters, launch.lookahead(), world ? &*world : nullptr);
    if (!life.run(interference, victim, last, stop)) return std::nullopt;
    if (cluster->is_coupled())
      cluster->crash_in_step(core::RegionId{static_cast<std::uint32_t>(victim)}, random() % kMostParcels);
    std::optional<core::WorldCut> saved = life.saved(victim);
    if (!saved) continue;  // begin again from state 0
    take_over(life.played(), from, saved->step, whole);
    from = saved->step;
    world = through_a_file(std::move(*saved));
  }
  bring_up();
  const auto rest =
      play(*cluster, interference, disasters.steps, launch.lookahead(), stop, nullptr, world ? &*world : nullptr);
  if (!rest) return std::nullopt;
  take_over(*rest, from, disasters.steps, whole);
  whole.bodies = rest->bodies;
  whole.broken = rest->broken;
  whole.cpu_s = thread_time_s() - begin_s;
  return whole;
}

}  // namespace aurasim::lab
