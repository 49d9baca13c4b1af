#include "physics/soft/layout.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "physics/soft/lanes.h"

namespace aurasim::physics {
namespace {

using soft::kLanes;

/// By phase: bits of the colours that there are.
constexpr std::uint64_t kAll = ~std::uint64_t{0};
constexpr std::uint64_t kAllowed[] = {kAll >> 24, kAll, kAll, kAll, kAll >> 40};
constexpr std::size_t kNoColour = 64;
/// Waiting for each other in all colours of a group costs the threads as much as this.
constexpr std::uint64_t kCostOfColours = 1000;

}  // namespace

void SoftLayout::clear(std::size_t movers, std::size_t kinds, std::size_t entries) {
  kinds_ = kinds;
  movers_ = movers;
  entries_.resize(entries);
}

void SoftLayout::put(std::size_t i, std::int32_t a, std::int32_t b, std::size_t kind, SoftPhase phase,
                     std::size_t group) {
  const bool with_static = a <= 0 || b <= 0;
  // the contacts of a body with statics share no body with others, so neighbours in the list of movers are a group
  if (with_static && stages_ > 1) group = static_cast<std::size_t>(std::max({0, a, b})) * kSoftGroups / movers_;
  entries_[i] = {a,
                 b,
                 static_cast<std::uint16_t>(kind),
                 static_cast<std::uint16_t>(group),
                 static_cast<std::uint8_t>(with_static ? kStatics : static_cast<std::size_t>(phase)),
                 0,
                 0,
                 0};
}

/// Sorts by phase, then by colour, then by kind; otherwise in the order of put().
std::size_t SoftLayout::place(soft::Team& team) {
  const auto threads = static_cast<std::size_t>(team.employed());
  costs_.resize(std::max(costs_.size(), threads));
  parts_.resize(std::max(parts_.size(), threads + 1));
  std::size_t blocks = 0;
  team.side_by_side([&](const soft::Worker& worker) {
    add_up(worker);
    worker.wait();
    if (worker.is_first()) share_out(threads);
    worker.wait();
    colour(worker);
    worker.wait();
    if (worker.is_first()) count_split(), blocks = make_runs(threads);
    worker.wait();
    place_part(static_cast<std::size_t>(worker.number) + 1);
    if (worker.is_first() && load_.split > 0) place_part(0);
  });
  return blocks;
}

/// Adds up the costs of groups in a worker's share of the entries.
void SoftLayout::add_up(const soft::Worker& worker) {
  Costs& costs = costs_[static_cast<std::size_t>(worker.number)];
  for (auto& of_phase : costs) of_phase.fill(0);
  const auto [first, last] = worker.share(entries_.size());
  for (std::size_t i = first; i < last; ++i) {
    const Entry& entry = entries_[i];
    costs[entry.phase][entry.group] += stages_ > 1 ? entry.kind + 1U : 4U;
  }
}

/// Decides which thread solves which group.
void SoftLayout::share_out(std::size_t threads) {
  load_ = {};
  Costs& all = costs_.front();
  for (std::size_t phase = 0; phase < kAllPhases; ++phase) {
    for (std::size_t i = 1; i < threads; ++i) {
      for (std::size_t group = 0; group < kSoftGroups; ++group) all[phase][group] += costs_[i][phase][group];
    }
    const std::uint64_t cost = std::accumulate(all[phase].begin(), all[phase].end(), std::uint64_t{0});
    used_[phase].assign(cost > 0 ? movers_ : 0, 0);
    load_.all += cost;
    if (stages_ > 1 || phase == 0) continue;
    for (std::size_t group = 0; group < kSoftGroups; ++group) all[0][group] += all[phase][group];
  }
  for (std::size_t stage = 0; stage < stages_; ++stage) share_out(stage, threads);
}

void SoftLayout::share_out(std::size_t stage, std::size_t threads) {
  const auto& costs = costs_.front()[stage];
  groups_.clear();
  std::uint64_t rest = 0;
  for (std::size_t group = 0; group < kSoftGroups; ++group) {
    if (costs[group] == 0) continue;
    groups_.push_back(static_cast<std::uint16_t>(group));
    rest += costs[group];
  }
  is_empty_[stage] = groups_.empty();
  while (!groups_.empty() && !share_out_in_order(stage, threads, rest)) {
    const auto heaviest = std::ranges::max_element(groups_, {}, [&](std::uint16_t group) { return costs[group]; });
    part_of_[stage][*heaviest] = 0;
    load_.split += costs[*heaviest];
    rest -= costs[*heaviest];
    groups_.erase(heaviest);
  }
}

/// Gives each thread groups that follow each other, so most of what a thread touches in different phases is the same.
/// Returns false if the load of one of them is too large.
bool SoftLayout::share_out_in_order(std::size_t stage, std::size_t threads, std::uint64_t rest) {
  const auto& costs = costs_.front()[stage];
  loads_.assign(threads, 0);
  std::uint64_t before = 0;
  for (const std::uint16_t group : groups_) {
    const std::size_t thread = std::min(threads - 1, (2 * before + costs[group]) * threads / (2 * rest));
    part_of_[stage][group] = static_cast<std::uint8_t>(thread + 1);
    loads_[thread] += costs[group];
    before += costs[group];
  }
  return std::ranges::max(loads_) <= rest / threads + kCostOfColours;
}

/// Gives the entries of a worker's groups their colours. Groups that all threads solve are coloured by one of them.
void SoftLayout::colour(const soft::Worker& worker) {
  const auto threads = static_cast<std::size_t>(worker.of), number = static_cast<std::size_t>(worker.number);
  Part& own = parts_[number + 1];
  own.next.assign(kAllPhases * kColours * kinds_, 0);
  own.colours = {};
  for (Entry& entry : entries_) {
    const std::uint8_t part = part_of_[stage_of(entry.phase)][entry.group];
    const bool is_own = part == number + 1;
    if (!is_own && !(part == 0 && entry.group % threads == number)) continue;
    entry.part = part;
    entry.colour = free_colour(entry);
    if (is_own) count(own, entry);
  }
}

/// The first free colour of the phase. If none is free, the entry is solved by itself, after the others of the phase.
std::uint8_t SoftLayout::free_colour(const Entry& entry) {
  std::vector<std::uint64_t>& used = used_[entry.phase];
  const auto body_a = static_cast<std::size_t>(std::max(0, entry.a));
  const auto body_b = static_cast<std::size_t>(std::max(0, entry.b));
  std::uint64_t taken = 0;  // statics, which all threads have, take no colour
  if (body_a > 0) taken |= used[body_a];
  if (body_b > 0) taken |= used[body_b];
  const std::uint64_t free = ~taken & kAllowed[entry.phase];
  if (body_a > 0) used[body_a] |= free & -free;
  if (body_b > 0) used[body_b] |= free & -free;
  return static_cast<std::uint8_t>(std::countr_zero(free));
}

void SoftLayout::count(Part& part, const Entry& entry) {
  ++part.next[row_of(entry)];
  part.colours[entry.phase] = std::max(part.colours[entry.phase], std::size_t{entry.colour} + 1);
}

/// Counts the entries that all threads solve together.
void SoftLayout::count_split() {
  Part& split = parts_.front();
  split.next.assign(kAllPhases * kColours * kinds_, 0);
  split.colours = {};
  if (load_.split == 0) return;
  for (const Entry& entry : entries_) {
    if (entry.part == 0) count(split, entry);
  }
}

/// Gives all entries their rows of blocks, by stage and part. Returns the number of blocks.
std::size_t SoftLayout::make_runs(std::size_t threads) {
  std::size_t blocks = 0;
  for (std::size_t i = 0; i <= threads; ++i) parts_[i].runs.clear();
  for (std::size_t stage = 0; stage < stages_; ++stage) {
    for (std::size_t i = 0; i <= threads; ++i) {
      Part& part = parts_[i];
      part.first_run[stage] = part.runs.size();
      for (std::size_t phase = 0; phase < kAllPhases; ++phase) {
        if (stage_of(phase) == stage) blocks = make_runs(part, phase, blocks);
      }
      part.first_run[stage + 1] = part.runs.size();
    }
  }
  return blocks;
}

/// `blocks`: number of blocks until now. Returns it with those of the part's phase.
std::size_t SoftLayout::make_runs(Part& part, std::size_t phase, std::size_t blocks) {
  for (std::size_t colour = 0; colour < part.colours[phase]; ++colour) {
    const bool alone = colour == kNoColour;
    const std::size_t before = part.runs.size();
    for (std::size_t kind = 0; kind < kinds_; ++kind) {
      std::uint32_t& next = part.next[(phase * kColours + colour) * kinds_ + kind];
      if (next == 0) continue;
      const std::size_t count = alone ? next : (next + kLanes - 1) / kLanes;
      next = static_cast<std::uint32_t>(blocks * kLanes);
      part.runs.push_back({blocks, count, kind, alone, false});
      blocks += count;
    }
    if (part.runs.size() > before) part.runs.back().ends = true;
  }
  return blocks;
}

void SoftLayout::place_part(std::size_t part) {
  std::vector<std::uint32_t>& next = parts_[part].next;
  for (Entry& entry : entries_) {
    if (entry.part != part) continue;
    std::uint32_t& to = next[row_of(entry)];
    entry.place = to;
    to += entry.colour == kNoColour ? kLanes : 1;
  }
}

std::size_t SoftLayout::block(std::size_t i) const { return entries_[i].place / kLanes; }
int SoftLayout::lane(std::size_t i) const { return static_cast<int>(entries_[i].place % kLanes); }

}  // namespace aurasim::physics
