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

  /// Starts a step: one cluster per group of bodies connected by `contacts` or `joints`. `hops[i]`: how many hops body
  /// i looks ahead (docs/design.md, "Who leaves"). The caller owns `paths` and `hops`.
  void begin(std::span<const Path> paths, std::span<const std::uint8_t> hops, std::span<const Contact> contacts,
             std::span<const Contact> joints);

  /// What differs from the state before.
  struct Change {
    std::span<const std::uint32_t> bodies;  ///< their paths may have changed; ascending
    std::span<const Contact> contacts;      ///< all new contacts are among these
  };
  /// Like begin(), from the clusters of the state before, which had the same bodies and joints. `contacts` and `joints`
  /// are in ascending order.
  void go_on(std::span<const Path> paths, std::span<const std::uint8_t> hops, std::span<const Contact> contacts,
             std::span<const Contact> joints, const Change& change);
  /// Unites the clusters of two bodies, as if a joint held them together. Call before the first complete().
  void hold_together(std::uint32_t a, std::uint32_t b);

  /// Names the bodies that are outside of our region. Call before the first complete().
  void note_outside(std::span<const std::uint32_t> bodies);
  /// Is every body of body i's cluster outside of our region, as far as the cluster is known?
  bool is_outside(std::uint32_t i) const { return bodies_[of(i)].outside == bodies_[of(i)].size; }
  /// Like complete(), but only until something is found that is not outside of our region. The two are not united then,
  /// and is_outside() is false of the cluster. Call after all complete() of the state.
  void complete_outside(std::uint32_t i);

  /// Completes the cluster of body `i`: no body outside it is linked to one inside.
  void complete(std::uint32_t i);

  /// Label of the cluster of body i: the index of one of its members.
  std::uint32_t of(std::uint32_t i) const { return bodies_[i].label; }
  int hops(std::uint32_t i) const { return hops_[i]; }
  /// Calls `visit(index)` for bodies of our other clusters that a member of body i's cluster may touch, looking
  /// `more_hops` hops further ahead than clusters do, until `visit` returns true. Returns whether it has.
  template <class Visit>
  bool any_near(std::uint32_t i, int more_hops, Visit&& visit) const;
  bool is_complete(std::uint32_t i) const { return bodies_[i].is_asked; }
  /// At least one body of each complete cluster; some appear more than once.
  std::span<const std::uint32_t> completed() const { return completed_; }
  std::size_t size(std::uint32_t i) const { return bodies_[of(i)].size; }
  /// Pairs that joined clusters. The links of one cluster form a tree of its members.
  std::vector<Contact> links() const;
  const OwnIndex& near() const { return near_; }

  /// Calls `visit(index)` for each member of body i's cluster.
  template <class Visit>
  void for_each_member(std::uint32_t i, Visit&& visit) const {
    std::uint32_t j = i;
    do {
      visit(j);
      j = bodies_[j].next;
    } while (j != i);
  }

 private:
  struct Body {
    std::uint32_t label = 0;
    std::uint32_t next = 0;     ///< the next member of its cluster, in a ring
    std::uint32_t size = 1;     ///< of a label: number of members
    std::uint32_t outside = 0;  ///< of a label: number of members outside of our region
    Contact link;               ///< of a body that is no label any more: the pair by which it ceased to be one
    bool is_asked = false;      ///< what it is linked to has been looked for, or is about to be
    bool is_loose = false;      ///< in go_on() only: its cluster is made anew
  };

  void unite(std::uint32_t a, std::uint32_t b);
  void look_around(std::uint32_t i);
  void find_linked(std::uint32_t i);
  bool begin_to_complete(std::uint32_t i);
  void ask_members(std::uint32_t i);
  void begin_step(std::span<const Path> paths, std::span<const std::uint8_t> hops);
  void loosen(std::uint32_t i);
  void unite_by(std::uint32_t i, std::span<const Contact> pairs);

  const Aura& aura_;
  std::span<const Path> paths_;
  std::span<const std::uint8_t> hops_;
  std::vector<Range> link_ranges_;  ///< by hops
  OwnIndex near_;
  std::vector<Body> bodies_;
  std::vector<std::uint32_t> completed_;  ///< bodies passed to complete()
  std::vector<std::uint32_t> counted_;    ///< labels with members outside, before the first complete()
  std::vector<std::uint32_t> altered_;    ///< a body of each cluster that is more than its contacts and joints make it
  std::vector<std::uint32_t> loose_;
  std::vector<std::uint32_t> to_ask_;
  std::vector<std::uint32_t> linked_;
};

template <class Visit>
bool Clusters::any_near(std::uint32_t i, int more_hops, Visit&& visit) const {
  bool found = false;
  for_each_member(i, [&](std::uint32_t member) {
    const Path& path = paths_[member];
    const int hops_ahead = hops(member) + more_hops;
    const Range range = aura_.link_range(hops_ahead);
    const auto range_at = [&](double speed_m_s) { return range.at(path.speed_m_s + speed_m_s); };
    near_.for_each_near(path.pose.p_WB, path.radius_m, range_at, [&](std::uint32_t other) {
      if (found || of(other) == of(i)) return;
      found = aura_.linked(path, paths_[other], hops_ahead) && visit(other);
    });
  });
  return found;
}

}  // namespace aurasim::core
