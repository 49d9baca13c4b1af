#include "core/cluster.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace aurasim::core {
namespace {

/// Four regions meet at a corner of a grid: a pull can come through three others. Looking further ahead than that has
/// made no difference in any run, and costs (docs/decisions/0006-hops.md).
constexpr int kMostHops = 3;

int hops_of(std::uint64_t regions) { return std::clamp(std::popcount(regions), 1, kMostHops); }

}  // namespace

void Clusters::begin(std::span<Path> paths, std::span<const double> speeds, std::span<const std::uint64_t> regions,
                     std::span<const Contact> contacts, std::span<const Contact> joints) {
  paths_ = paths;
  const auto n = paths.size();
  parent_.resize(n);
  next_.resize(n);
  std::iota(parent_.begin(), parent_.end(), 0u);
  std::iota(next_.begin(), next_.end(), 0u);
  size_.assign(n, 1);
  speed_.assign(speeds.begin(), speeds.end());
  regions_.assign(regions.begin(), regions.end());
  most_hops_ = 1;
  for (const std::uint64_t bits : regions) note_hops(bits);
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
}

std::uint32_t Clusters::of(std::uint32_t i) const {
  while (parent_[i] != i) i = parent_[i];
  return i;
}

int Clusters::hops(std::uint32_t i) const { return hops_of(regions_[of(i)]); }

bool Clusters::add_regions(std::uint32_t i, std::uint64_t regions) {
  const std::uint32_t cluster = of(i);
  if ((regions & ~regions_[cluster]) == 0) return false;
  regions_[cluster] |= regions;
  note_hops(regions_[cluster]);
  complete_[cluster] = 0;
  return true;
}

std::uint32_t Clusters::unite(std::uint32_t a, std::uint32_t b) {
  const Contact link{a, b};
  a = of(a);
  b = of(b);
  if (a == b) return a;
  links_.push_back(link);
  if (size_[a] < size_[b]) std::swap(a, b);
  parent_[b] = a;
  size_[a] += size_[b];
  speed_[a] = std::max(speed_[a], speed_[b]);
  regions_[a] |= regions_[b];
  note_hops(regions_[a]);
  complete_[a] = complete_[a] | complete_[b];
  std::swap(next_[a], next_[b]);  // splices the two rings of members
  return a;
}

void Clusters::note_hops(std::uint64_t regions) { most_hops_ = std::max(most_hops_, hops_of(regions)); }

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

void Clusters::look_around(std::uint32_t i) {
  std::uint32_t mine = of(i);
  const auto hops_with = [&](std::uint32_t j) { return std::max(hops(i), hops(j)); };
  const double slow = aura_.link_range(speed_[mine], NearIndex::kSlow, most_hops_);
  const double fast = aura_.link_range(speed_[mine], near_.top_speed(), most_hops_);
  linked_.clear();
  near_.for_each_near(paths_[i].pose.p_WB, paths_[i].radius_m, slow, fast, [&](std::uint32_t j) {
    if (of(j) == mine) return;
    const int hops_pair = hops_with(j);
    const double range =
        aura_.link_range(speed_[mine], speed_[of(j)], hops_pair) + paths_[i].radius_m + paths_[j].radius_m;
    if ((paths_[i].pose.p_WB - paths_[j].pose.p_WB).squaredNorm() > range * range) return;
    if (aura_.linked(paths_[i], paths_[j], hops_pair)) linked_.push_back(j);
  });
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
