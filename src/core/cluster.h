// Clusters: bodies of one host that must move together, because they touch, are jointed, or may touch on their
// predicted paths. Only clusters for which complete() is called are completed.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/aura.h"
#include "core/own_index.h"

namespace aurasim::core {

class Clusters {
 public:
  explicit Clusters(const Aura& aura) : aura_(aura) {}

  /// Starts a step: one cluster per group of bodies connected by `contacts` or `joints`. `regions[i]` has a bit for
  /// every other region in reach of body i. The caller owns `paths`.
  void begin(std::span<const Path> paths, std::span<const std::uint64_t> regions, std::span<const Contact> contacts,
             std::span<const Contact> joints);

  /// What differs from the state before.
  struct Change {
    std::span<const std::uint32_t> bodies;    ///< their paths may have changed; ascending
    std::span<const Contact> contacts;        ///< all new contacts are among these
    std::span<const std::uint32_t> in_reach;  ///< other regions are in reach of these bodies, and of no others
  };
  /// Like begin(), from the clusters of the state before, which had the same bodies and joints. `contacts` and `joints`
  /// are in ascending order.
  void go_on(std::span<const Path> paths, std::span<const std::uint64_t> regions, std::span<const Contact> contacts,
             std::span<const Contact> joints, const Change& change);
  /// Unites the clusters of two bodies, as if a joint held them together. Call before the first complete().
  void hold_together(std::uint32_t a, std::uint32_t b);

  /// Notes that `regions` (bits) have bodies near body i. Returns false if that was known; otherwise the cluster has to
  /// be completed again.
  bool add_regions(std::uint32_t i, std::uint64_t regions);

  /// Completes the cluster of body `i`: no body outside it is linked to one inside.
  void complete(std::uint32_t i);

  /// Label of the cluster of body i: the index of one of its members.
  std::uint32_t of(std::uint32_t i) const { return label_[i]; }
  /// Number of other regions through which a pull on this cluster can chain (docs/design.md, "Who leaves"): those
  /// in reach, by their territory or by a body of theirs; at least 1.
  int hops(std::uint32_t i) const { return hops_[of(i)]; }
  /// The largest hops() of any cluster.
  int most_hops() const { return most_hops_; }
  /// Replaces `grown` by the bodies whose hops have grown since the last call; some appear more than once.
  void take_grown(std::vector<std::uint32_t>& grown) {
    grown.clear();
    std::swap(grown, grown_);
  }
  /// Calls `visit(index)` for bodies of our other clusters that a member of body i's cluster may touch, looking
  /// `more_hops` hops further ahead than clusters do, until `visit` returns true. Returns whether it has.
  template <class Visit>
  bool any_near(std::uint32_t i, int more_hops, Visit&& visit) const;
  bool is_complete(std::uint32_t i) const { return complete_[of(i)] != 0; }
  /// At least one body of each complete cluster; some appear more than once.
  std::span<const std::uint32_t> completed() const { return completed_; }
  std::size_t size(std::uint32_t i) const { return size_[of(i)]; }
  /// Pairs that joined clusters. The links of one cluster form a tree of its members.
  std::vector<Contact> links() const;
  const OwnIndex& near() const { return near_; }

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
  void link(std::uint32_t i, std::uint32_t j);
  void look_around(std::uint32_t i);
  void ask_members(std::uint32_t i);
  void set_regions(std::uint32_t cluster, std::uint64_t regions);
  void note_more_hops(std::uint32_t i, int hops);
  void begin_step(std::span<const Path> paths);
  void loosen(std::uint32_t i);
  void unite_by(std::uint32_t i, std::span<const Contact> pairs);

  const Aura& aura_;
  std::span<const Path> paths_;
  int most_hops_ = 1;
  std::vector<std::uint32_t> grown_;
  std::vector<Range> link_ranges_;  ///< by hops
  OwnIndex near_;
  std::vector<std::uint32_t> label_, next_, size_;
  std::vector<std::uint64_t> regions_;
  std::vector<int> hops_;
  std::vector<std::uint8_t> complete_;
  std::vector<Contact> links_;            ///< by body that is no label any more: the pair by which it ceased to be one
  std::vector<std::uint32_t> completed_;  ///< bodies passed to complete()
  std::vector<std::uint32_t> altered_;    ///< a body of each cluster that is more than its contacts and joints make it
  std::vector<std::uint8_t> is_loose_;    ///< by body, in go_on() only: its cluster is made anew
  std::vector<std::uint32_t> loose_;
  std::vector<int> asked_hops_;  ///< by body: its hops at the last look_around(); 0: there was none
  std::vector<std::uint32_t> to_ask_;
  std::vector<std::uint32_t> linked_;
};

template <class Visit>
bool Clusters::any_near(std::uint32_t i, int more_hops, Visit&& visit) const {
  const int hops_ahead = hops(i) + more_hops;
  const Range range = aura_.link_range(hops_ahead);
  bool found = false;
  for_each_member(i, [&](std::uint32_t member) {
    const Path& path = paths_[member];
    const auto range_at = [&](double speed_m_s) { return range.at(path.speed_m_s + speed_m_s); };
    near_.for_each_near(path.pose.p_WB, path.radius_m, range_at, [&](std::uint32_t other) {
      if (found || of(other) == of(i)) return;
      found = aura_.linked(path, paths_[other], hops_ahead) && visit(other);
    });
  });
  return found;
}

}  // namespace aurasim::core
