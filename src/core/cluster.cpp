#include "core/cluster.h"

#include <algorithm>

#include "core/horizon.h"
#include "core/progress.h"

namespace aurasim::core {

/// What begin() and go_on() have in common.
void Clusters::begin_step(std::span<const Path> paths, std::span<const std::uint8_t> hops) {
  paths_ = paths;
  hops_ = hops;
  link_ranges_.clear();
  for (int h = 0; h <= aura_.rules().most_hops(); ++h) link_ranges_.push_back(aura_.link_range(h));
  completed_.clear();
}

void Clusters::begin(std::span<const Path> paths, std::span<const std::uint8_t> hops, std::span<const Contact> contacts,
                     std::span<const Contact> joints) {
  begin_step(paths, hops);
  bodies_.assign(paths.size(), {});
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) bodies_[i].label = bodies_[i].next = i;
  altered_.clear();
  counted_.clear();
  near_.build(paths);
  if (!aura_.warns()) return;
  for (const Contact& c : contacts) unite(c.a, c.b);
  for (const Contact& j : joints) unite(j.a, j.b);
}

/// Clusters that were looked at, and those of changed bodies, are made anew of their contacts and joints. The others
/// are what these make them already.
void Clusters::go_on(std::span<const Path> paths, std::span<const std::uint8_t> hops, std::span<const Contact> contacts,
                     std::span<const Contact> joints, const Change& change) {
  begin_step(paths, hops);
  near_.renew(paths, change.bodies);
  for (const std::uint32_t label : counted_) bodies_[label].outside = 0;
  counted_.clear();
  loose_.clear();
  for (const std::uint32_t i : altered_) loosen(i);
  for (const std::uint32_t i : change.bodies) loosen(i);
  altered_.clear();
  for (const std::uint32_t i : loose_) bodies_[i].is_loose = false;
  if (!aura_.warns()) return;
  for (const std::uint32_t i : loose_) {
    unite_by(i, contacts);
    unite_by(i, joints);
  }
  for (const Contact& c : change.contacts) unite(c.a, c.b);
}

/// Dissolves the cluster of body i.
void Clusters::loosen(std::uint32_t i) {
  if (bodies_[i].is_loose) return;
  const std::size_t first = loose_.size();
  for_each_member(i, [this](std::uint32_t j) { loose_.push_back(j); });
  for (const std::uint32_t j : std::span(loose_).subspan(first)) {
    bodies_[j] = {};
    bodies_[j].label = bodies_[j].next = j;
    bodies_[j].is_loose = true;
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

void Clusters::note_outside(std::span<const std::uint32_t> bodies) {
  for (const std::uint32_t i : bodies) {
    ++bodies_[of(i)].outside;
    counted_.push_back(of(i));
  }
}

std::vector<Contact> Clusters::links() const {
  std::vector<Contact> links;
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    if (of(i) != i) links.push_back(bodies_[i].link);
  }
  return links;
}

/// Unites two clusters. The smaller one takes the label of the larger, so each body's label changes at most log2(n)
/// times.
void Clusters::unite(std::uint32_t a, std::uint32_t b) {
  const Contact link{a, b};
  a = of(a);
  b = of(b);
  if (a == b) return;
  if (bodies_[a].size < bodies_[b].size) std::swap(a, b);
  bodies_[b].link = link;
  for_each_member(b, [&](std::uint32_t j) { bodies_[j].label = a; });
  bodies_[a].size += bodies_[b].size;
  bodies_[a].outside += bodies_[b].outside;
  std::swap(bodies_[a].next, bodies_[b].next);  // splices the two rings of members
}

void Clusters::ask_members(std::uint32_t i) {
  for_each_member(i, [this](std::uint32_t j) {
    if (!bodies_[j].is_asked) to_ask_.push_back(j);
    bodies_[j].is_asked = true;
  });
}

/// False: it has been begun before.
bool Clusters::begin_to_complete(std::uint32_t i) {
  if (bodies_[i].is_asked) return false;
  completed_.push_back(i);
  altered_.push_back(i);
  ask_members(i);
  return true;
}

void Clusters::complete(std::uint32_t i) {
  if (!begin_to_complete(i)) return;
  while (aura_.warns() && !to_ask_.empty()) {
    const std::uint32_t j = to_ask_.back();
    to_ask_.pop_back();
    Progress::mark();
    look_around(j);
  }
  to_ask_.clear();
}

void Clusters::complete_outside(std::uint32_t i) {
  if (!is_outside(i) || !begin_to_complete(i)) return;
  while (aura_.warns() && !to_ask_.empty() && is_outside(i)) {
    const std::uint32_t j = to_ask_.back();
    to_ask_.pop_back();
    Progress::mark();
    find_linked(j);
    for (const std::uint32_t other : linked_) {
      if (!is_outside(other)) {
        bodies_[of(i)].outside = 0;
        break;
      }
      ask_members(other);
      unite(i, other);
    }
  }
  to_ask_.clear();
}

/// Unites body i with those that it may touch.
void Clusters::look_around(std::uint32_t i) {
  find_linked(i);
  for (const std::uint32_t j : linked_) {
    ask_members(j);
    unite(i, j);
  }
}

/// Lists the bodies of other clusters that body i may touch.
void Clusters::find_linked(std::uint32_t i) {
  const Path& path = paths_[i];
  linked_.clear();
  const auto ask = [&](std::uint32_t j) {
    if (of(j) == of(i)) return;
    const int hops_both = std::max(hops(i), hops(j));
    const double range = link_ranges_[static_cast<std::size_t>(hops_both)].at(path.speed_m_s + paths_[j].speed_m_s) +
                         path.radius_m + paths_[j].radius_m;
    if ((path.pose.p_WB - paths_[j].pose.p_WB).squaredNorm() > range * range) return;
    if (aura_.linked(path, paths_[j], hops_both)) linked_.push_back(j);
  };
  const auto range_at = [&](double speed_m_s) { return link_ranges_.back().at(path.speed_m_s + speed_m_s); };
  near_.for_each_near(path.pose.p_WB, path.radius_m, range_at, ask);
}

}  // namespace aurasim::core
