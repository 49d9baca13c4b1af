// Bodies of a table that may have changed since a reader last looked at them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "core/keep_one_of_each.h"
#include "physics/body_table.h"

namespace aurasim::physics {

/// Named by id, because places in the table change when bodies come or go. Nothing is allocated once warm.
class ChangedBodies {
 public:
  void note(core::BodyId id) {
    if (all_) return;
    ids_.push_back(id);
    if (ids_.size() > 2 * known_ + kFew) sort_out();
  }
  /// Notes many bodies, ascending.
  void note(std::span<const core::BodyId> ids) {
    if (all_) return;
    sort_out();
    add(ids);
  }
  /// Any body may have changed.
  void note_all() {
    clear();
    all_ = true;
  }
  bool all() const { return all_; }
  /// The noted bodies, ascending, also those that are in no table any more. Precondition: not all().
  const std::vector<core::BodyId>& ids() {
    sort_out();
    return ids_;
  }
  /// At least the number of noted bodies.
  std::size_t most() const { return ids_.size(); }
  void clear() {
    ids_.clear();
    known_ = 0;
    all_ = false;
  }

  /// Frees the memory that many noted bodies have used.
  void free_spare_memory() {
    fresh_ = {}, merged_ = {};
    ids_.shrink_to_fit();
  }

  /// Calls `visit(body, place)` once for each noted body that is in the table, in ascending order.
  template <class Visit>
  void for_each(BodyTable& table, Visit&& visit) {
    if (all_) {
      for (std::size_t i = 0; i < table.size(); ++i) visit(table[i], i);
      return;
    }
    sort_out();
    std::size_t near = 0;
    for (const core::BodyId id : ids_) {
      if (HostedBody* const body = table.find(id, near)) visit(*body, near);
    }
  }

 private:
  static constexpr std::size_t kFew = 256;

  void sort_out() {
    if (ids_.size() == known_) return;
    fresh_.assign(ids_.begin() + static_cast<std::ptrdiff_t>(known_), ids_.end());
    ids_.resize(known_);
    core::keep_one_of_each(fresh_);
    add(fresh_);
  }
  /// Adds `ids`, ascending. Precondition: the noted ones are sorted.
  void add(std::span<const core::BodyId> ids) {
    if (ids_.empty()) {
      ids_.assign(ids.begin(), ids.end());
    } else if (!std::ranges::includes(ids_, ids)) {
      merged_.clear();
      std::ranges::set_union(ids_, ids, std::back_inserter(merged_));
      std::swap(ids_, merged_);
    }
    known_ = ids_.size();
  }

  bool all_ = false;
  std::vector<core::BodyId> ids_;
  std::size_t known_ = 0;                     ///< so many of ids_ are sorted, without duplicates
  std::vector<core::BodyId> fresh_, merged_;  ///< scratch
};

}  // namespace aurasim::physics
