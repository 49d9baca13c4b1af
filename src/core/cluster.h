// Clusters: bodies of one host that must move together, because they touch, are jointed, or may touch on their
// predicted paths. A cluster's top speed decides how far it looks ahead, and looking further may make it larger, so
// both grow until neither does. Only clusters that somebody asks for are completed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/near_index.h"

namespace aurasim::core {

class Clusters {
 public:
  explicit Clusters(const Aura& aura) : aura_(aura) {}

  /// Starts a step: one cluster per group of bodies connected by `contacts` or `joints`.
  /// `speeds` are Aura::speed_of each body; `regions[i]` has a bit for every other region in reach of body i.
  /// Paths stay the caller's; their speed_m_s is kept up to date here.
  void begin(std::span<Path> paths, std::span<const double> speeds, std::span<const std::uint64_t> regions,
             std::span<const Contact> contacts, std::span<const Contact> joints);

  /// Another region has a body near body i. False when that was known; otherwise the cluster has to be completed again.
  bool add_regions(std::uint32_t i, std::uint64_t regions);

  /// Completes the cluster of body `i`: no body outside it is linked to one inside.
  void complete(std::uint32_t i);

  /// The cluster of a body, as the index of one of its members.
  std::uint32_t of(std::uint32_t i) const { return label_[i]; }
  double speed(std::uint32_t i) const { return speed_[of(i)]; }
  /// Number of other regions through which a pull on this cluster can chain (DESIGN section 4, corners): those in
  /// reach, by their territory or by a body of theirs; at least 1.
  int hops(std::uint32_t i) const { return hops_[of(i)]; }
  /// The largest hops() of any cluster.
  int most_hops() const { return most_hops_; }
  /// Grows whenever a cluster turns out faster, or has more hops, than it seemed.
  std::uint64_t growth() const { return growth_; }
  bool is_complete(std::uint32_t i) const { return complete_[of(i)] != 0; }
  std::size_t size(std::uint32_t i) const { return size_[of(i)]; }
  /// The pairs by which clusters came to be one: a tree of each cluster.
  std::span<const Contact> links() const { return links_; }
  const NearIndex& near() const { return near_; }

  /// Calls `visit(index)` for each member of body i's cluster.
  template <class Visit>
  void for_each_member(std::uint32_t i, Visit&& visit) const {
    std::uint32_t j = i;
    do {
      visit(j);
      j = next_[j];
    } while (j != i);
  }

 private:
  std::uint32_t unite(std::uint32_t a, std::uint32_t b);
  bool owns(std::uint32_t mine, std::uint32_t group);
  void look_around(std::uint32_t i);
  void push_members(std::uint32_t i);
  void set_regions(std::uint32_t cluster, std::uint64_t regions);
  void spread_speed(std::uint32_t cluster);

  const Aura& aura_;
  std::span<Path> paths_;
  int most_hops_ = 1;
  std::uint64_t growth_ = 0;
  std::vector<Aura::Range> link_ranges_;  ///< by hops
  NearIndex near_;
  std::vector<std::uint32_t> group_owner_;  ///< by group of near_: one of its bodies, once all are of one cluster
  std::vector<std::uint32_t> label_, next_, size_;
  std::vector<double> speed_;
  std::vector<std::uint64_t> regions_;
  std::vector<int> hops_;
  std::vector<std::uint8_t> complete_;
  std::vector<Contact> links_;
  std::vector<double> asked_speed_;  ///< with which speed and hops a body last looked around
  std::vector<int> asked_hops_;
  std::vector<std::uint32_t> to_ask_;
  std::vector<std::uint32_t> linked_;
  std::vector<double> body_speed_;
};

}  // namespace aurasim::core
