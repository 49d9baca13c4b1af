#include "core/cluster.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "core/horizon.h"
#include "core/progress.h"

namespace aurasim::core {
namespace {

int hops_of(std::uint64_t regions, const AuraRules& rules) {
  return std::clamp(std::popcount(regions), 1, rules.pulls_chain() ? horizon::kMostHops : 1);
}

}  // namespace

/// What begin() and go_on() have in common.
void Clusters::begin_step(std::span<const Path> paths) {
  paths_ = paths;
  most_hops_ = 1;
  link_ranges_.clear();
  for (int hops = 0; hops <= horizon::kMostHops; ++hops) link_ranges_.push_back(aura_.link_range(hops));
  grown_.clear();
  completed_.clear();
}

void Clusters::begin(std::span<const Path> paths, std::span<const std::uint64_t> regions,
                     std::span<const Contact> contacts, std::span<const Contact> joints) {
  begin_step(paths);
  const auto n = paths.size();
  label_.resize(n);
  next_.resize(n);
  std::iota(label_.begin(), label_.end(), 0u);
  std::iota(next_.begin(), next_.end(), 0u);
  size_.assign(n, 1);
  regions_.resize(n);
  hops_.assign(n, 1);
  for (std::uint32_t i = 0; i < n; ++i) set_regions(i, regions[i]);
  complete_.assign(n, 0);
  links_.resize(n);
  asked_hops_.assign(n, 0);
  is_loose_.assign(n, 0);
  altered_.clear();
  near_.build(paths);
  if (!aura_.warns()) return;
  for (const Contact& c : contacts) unite(c.a, c.b);
  for (const Contact& j : joints) unite(j.a, j.b);
}

/// Clusters that were looked at, and those of changed bodies, are made anew of their contacts and joints. The others
/// are what these make them already.
void Clusters::go_on(std::span<const Path> paths, std::span<const std::uint64_t> regions,
                     std::span<const Contact> contacts, std::span<const Contact> joints, const Change& change) {
  begin_step(paths);
  near_.renew(paths, change.bodies);
  loose_.clear();
  for (const std::uint32_t i : altered_) loosen(i);
  for (const std::uint32_t i : change.bodies) loosen(i);
  for (const std::uint32_t i : change.in_reach) loosen(i);
  altered_.clear();
  for (const std::uint32_t i : loose_) {
    is_loose_[i] = 0;
    set_regions(i, regions[i]);
  }
  if (!aura_.warns()) return;
  for (const std::uint32_t i : loose_) {
    unite_by(i, contacts);
    unite_by(i, joints);
  }
  for (const Contact& c : change.contacts) unite(c.a, c.b);
}

/// Dissolves the cluster of body i.
void Clusters::loosen(std::uint32_t i) {
  if (is_loose_[i]) return;
  const std::size_t first = loose_.size();
  for_each_member(i, [this](std::uint32_t j) { loose_.push_back(j); });
  for (const std::uint32_t j : std::span(loose_).subspan(first)) {
    label_[j] = next_[j] = j;
    size_[j] = 1;
    complete_[j] = 0;
    asked_hops_[j] = 0;
    is_loose_[j] = 1;
  }
}

/// Unites body i with the second bodies of those `pairs`, in ascending order, whose first one it is.
void Clusters::unite_by(std::uint32_t i, std::span<const Contact> pairs) {
  for (auto pair = std::ranges::lower_bound(pairs, i, {}, &Contact::a); pair != pairs.end() && pair->a == i; ++pair) {
    unite(pair->a, pair->b);
  }
}

void Clusters::hold_together(std::uint32_t a, std::uint32_t b) {
  if (!aura_.warns()) return;
  unite(a, b);
  altered_.push_back(a);
}

std::vector<Contact> Clusters::links() const {
  std::vector<Contact> links;
  for (std::uint32_t i = 0; i < label_.size(); ++i) {
    if (label_[i] != i) links.push_back(links_[i]);
  }
  return links;
}

void Clusters::set_regions(std::uint32_t cluster, std::uint64_t regions) {
  regions_[cluster] = regions;
  const int hops = hops_of(regions, aura_.rules());
  hops_[cluster] = hops;
  most_hops_ = std::max(most_hops_, hops);
}

/// Call before the cluster of body `i` gets `hops`: notes its members as grown if that is more than before.
void Clusters::note_more_hops(std::uint32_t i, int hops) {
  if (hops <= hops_[of(i)]) return;
  for_each_member(i, [this](std::uint32_t j) { grown_.push_back(j); });
}

bool Clusters::add_regions(std::uint32_t i, std::uint64_t regions) {
  const std::uint32_t cluster = of(i);
  if ((regions & ~regions_[cluster]) == 0) return false;
  altered_.push_back(i);
  const std::uint64_t all = regions_[cluster] | regions;
  note_more_hops(i, hops_of(all, aura_.rules()));
  set_regions(cluster, all);
  complete_[cluster] = 0;
  return true;
}

/// Unites two clusters. The smaller one takes the label of the larger, so each body's label changes at most log2(n)
/// times.
std::uint32_t Clusters::unite(std::uint32_t a, std::uint32_t b) {
  const Contact link{a, b};
  a = of(a);
  b = of(b);
  if (a == b) return a;
  if (size_[a] < size_[b]) std::swap(a, b);
  links_[b] = link;
  const std::uint64_t all = regions_[a] | regions_[b];
  note_more_hops(a, hops_of(all, aura_.rules()));
  note_more_hops(b, hops_of(all, aura_.rules()));
  for_each_member(b, [&](std::uint32_t j) { label_[j] = a; });
  size_[a] += size_[b];
  set_regions(a, all);
  complete_[a] = complete_[a] | complete_[b];
  std::swap(next_[a], next_[b]);  // splices the two rings of members
  return a;
}

void Clusters::ask_members(std::uint32_t i) {
  for_each_member(i, [this](std::uint32_t j) { to_ask_.push_back(j); });
}

void Clusters::complete(std::uint32_t i) {
  if (complete_[of(i)]) return;
  complete_[of(i)] = 1;
  completed_.push_back(i);
  altered_.push_back(i);
  if (!aura_.warns()) return;
  ask_members(i);
  while (!to_ask_.empty()) {
    const std::uint32_t j = to_ask_.back();
    to_ask_.pop_back();
    if (asked_hops_[j] >= hops(j)) continue;
    asked_hops_[j] = hops(j);
    Progress::mark();
    look_around(j);
  }
}

void Clusters::look_around(std::uint32_t i) {
  const int hops_here = hops(i);
  const Path& path = paths_[i];
  const Range& widest = link_ranges_[static_cast<std::size_t>(most_hops_)];
  linked_.clear();
  const auto ask = [&](std::uint32_t j) {
    if (of(j) == of(i)) return;
    const int hops_both = std::max(hops_here, hops(j));
    const double range = link_ranges_[static_cast<std::size_t>(hops_both)].at(path.speed_m_s + paths_[j].speed_m_s) +
                         path.radius_m + paths_[j].radius_m;
    if ((path.pose.p_WB - paths_[j].pose.p_WB).squaredNorm() > range * range) return;
    if (aura_.linked(path, paths_[j], hops_both)) linked_.push_back(j);
  };
  const auto range_at = [&](double speed_m_s) { return widest.at(path.speed_m_s + speed_m_s); };
  near_.for_each_near(path.pose.p_WB, path.radius_m, range_at, ask);
  for (const std::uint32_t j : linked_) link(i, j);
}

/// Bodies i and j may touch: unites their clusters. Members that now have more hops, or that are new, are asked.
void Clusters::link(std::uint32_t i, std::uint32_t j) {
  const std::uint32_t theirs = of(j);
  if (theirs == of(i)) return;
  const bool more_regions = (regions_[theirs] & ~regions_[of(i)]) != 0;
  if (!more_regions) ask_members(j);
  unite(i, j);
  if (more_regions) ask_members(i);
}

}  // namespace aurasim::core
