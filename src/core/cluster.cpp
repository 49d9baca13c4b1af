#include "core/cluster.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace aurasim::core {
namespace {

/// Four regions meet at a corner of a grid: a pull can come through three others. Looking further ahead than that has
/// made no difference in any run, and costs (docs/decisions/0006-hops.md).
constexpr int kMostHops = 3;

/// A group of near_ whose bodies are not known to be of one cluster.
constexpr std::uint32_t kSeveral = ~0u;

int hops_of(std::uint64_t regions) { return std::clamp(std::popcount(regions), 1, kMostHops); }

}  // namespace

void Clusters::begin(std::span<Path> paths, std::span<const double> speeds, std::span<const std::uint64_t> regions,
                     std::span<const Contact> contacts, std::span<const Contact> joints) {
  paths_ = paths;
  const auto n = paths.size();
  label_.resize(n);
  next_.resize(n);
  std::iota(label_.begin(), label_.end(), 0u);
  std::iota(next_.begin(), next_.end(), 0u);
  size_.assign(n, 1);
  speed_.assign(speeds.begin(), speeds.end());
  regions_.resize(n);
  hops_.assign(n, 1);
  most_hops_ = 1;
  for (std::uint32_t i = 0; i < n; ++i) set_regions(i, regions[i]);
  link_ranges_.clear();
  for (int hops = 0; hops <= kMostHops; ++hops) link_ranges_.push_back(aura_.link_range(hops));
  complete_.assign(n, 0);
  links_.clear();
  asked_speed_.assign(n, -1);
  asked_hops_.assign(n, 0);
  if (aura_.rules().kind != AuraKind::kNone) {
    for (const Contact& c : contacts) unite(c.a, c.b);
    for (const Contact& j : joints) unite(j.a, j.b);
  }
  body_speed_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    body_speed_[i] = speed(i);
    paths_[i].speed_m_s = body_speed_[i];
  }
  near_.build(paths, body_speed_);
  group_owner_.assign(near_.group_count(), kSeveral);
}

void Clusters::set_regions(std::uint32_t cluster, std::uint64_t regions) {
  regions_[cluster] = regions;
  const int hops = hops_of(regions);
  if (hops > hops_[cluster]) ++growth_;
  hops_[cluster] = hops;
  most_hops_ = std::max(most_hops_, hops);
}

bool Clusters::add_regions(std::uint32_t i, std::uint64_t regions) {
  const std::uint32_t cluster = of(i);
  if ((regions & ~regions_[cluster]) == 0) return false;
  set_regions(cluster, regions_[cluster] | regions);
  complete_[cluster] = 0;
  return true;
}

/// The smaller one takes the label of the larger: each body's label changes at most log2(n) times.
std::uint32_t Clusters::unite(std::uint32_t a, std::uint32_t b) {
  const Contact link{a, b};
  a = of(a);
  b = of(b);
  if (a == b) return a;
  links_.push_back(link);
  if (size_[a] < size_[b]) std::swap(a, b);
  for_each_member(b, [&](std::uint32_t j) { label_[j] = a; });
  size_[a] += size_[b];
  growth_ += speed_[a] != speed_[b] || regions_[a] != regions_[b];
  speed_[a] = std::max(speed_[a], speed_[b]);
  set_regions(a, regions_[a] | regions_[b]);
  complete_[a] = complete_[a] | complete_[b];
  std::swap(next_[a], next_[b]);  // splices the two rings of members
  return a;
}

void Clusters::push_members(std::uint32_t i) {
  for_each_member(i, [this](std::uint32_t j) { to_ask_.push_back(j); });
}

void Clusters::complete(std::uint32_t i) {
  if (complete_[of(i)]) return;
  complete_[of(i)] = 1;
  if (aura_.rules().kind == AuraKind::kNone) return;
  push_members(i);
  while (!to_ask_.empty()) {
    const std::uint32_t j = to_ask_.back();
    to_ask_.pop_back();
    const std::uint32_t cluster = of(j);
    const int hops_now = hops(j);
    if (asked_speed_[j] >= speed_[cluster] && asked_hops_[j] >= hops_now) continue;
    asked_speed_[j] = speed_[cluster];
    asked_hops_[j] = hops_now;
    look_around(j);
  }
}

void Clusters::spread_speed(std::uint32_t cluster) {
  const double speed = speed_[of(cluster)];
  for_each_member(cluster, [&](std::uint32_t j) {
    if (paths_[j].speed_m_s <= NearIndex::kSlow && speed > NearIndex::kSlow) near_.raise(j);
    paths_[j].speed_m_s = speed;
  });
}

/// Are all bodies of the group in cluster `mine`? Once they are of one cluster, they stay together.
bool Clusters::owns(std::uint32_t mine, std::uint32_t group) {
  std::uint32_t& owner = group_owner_[group];
  if (owner == kSeveral) {
    const std::uint32_t first = near_.any_of(group);
    if (of(first) != mine) return false;
    if (!near_.all_of(group, [&](std::uint32_t j) { return of(j) == mine; })) return false;
    owner = first;
  }
  return of(owner) == mine;
}

void Clusters::look_around(std::uint32_t i) {
  std::uint32_t mine = of(i);
  const double speed = speed_[mine];
  const int hops_here = hops_[mine];
  const Path& path = paths_[i];
  const Aura::Range& widest = link_ranges_[static_cast<std::size_t>(most_hops_)];
  linked_.clear();
  const auto is_ours = [&](std::uint32_t group) { return owns(mine, group); };
  const auto ask = [&](std::uint32_t j) {
    const std::uint32_t theirs = of(j);
    if (theirs == mine) return;
    const int hops = std::max(hops_here, hops_[theirs]);
    const double range =
        link_ranges_[static_cast<std::size_t>(hops)].at(speed + speed_[theirs]) + path.radius_m + paths_[j].radius_m;
    if ((path.pose.p_WB - paths_[j].pose.p_WB).squaredNorm() > range * range) return;
    if (aura_.linked(path, paths_[j], hops)) linked_.push_back(j);
  };
  near_.for_each_near(path.pose.p_WB, path.radius_m, widest.at(speed + NearIndex::kSlow),
                      widest.at(speed + near_.top_speed()), is_ours, ask);
  for (const std::uint32_t j : linked_) {
    const std::uint32_t theirs = of(j);
    mine = of(i);
    if (theirs == mine) continue;
    const bool grew = speed_[theirs] > speed_[mine] || (regions_[theirs] & ~regions_[mine]) != 0;
    if (!grew) push_members(j);
    const bool slower = speed_[theirs] < speed_[mine];
    mine = unite(i, j);
    if (grew) push_members(mine);
    if (grew || slower) spread_speed(mine);
  }
}

}  // namespace aurasim::core
