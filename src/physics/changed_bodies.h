// Bodies of a table that may have changed since a reader last looked at them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
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
    if (ids_.size() > known_ && !(ids_.back() < id)) {
      // Steps note their bodies in ascending order, so here the next step begins. Merging is faster than sorting.
      if (ascends_ && 2 * (ids_.size() - known_) >= known_) {
        sort_out();
      } else {
        ascends_ = false;
      }
    }
    ids_.push_back(id);
    if (ids_.size() > 2 * known_ + kFew && !ascends_) sort_out();
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
    ascends_ = true;
    all_ = false;
  }

  /// Frees the memory that many noted bodies have used.
  void free_spare_memory() {
    merged_ = {};
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
    const auto noted_since = ids_.begin() + static_cast<std::ptrdiff_t>(known_);
    if (!ascends_) {
      core::keep_one_of_each(ids_);
    } else if (known_ > 0 && noted_since != ids_.end()) {
      merged_.clear();
      std::set_union(ids_.begin(), noted_since, noted_since, ids_.end(), std::back_inserter(merged_));
      std::swap(ids_, merged_);
    }
    known_ = ids_.size();
    ascends_ = true;
  }

  bool all_ = false;
  std::vector<core::BodyId> ids_;
  std::vector<core::BodyId> merged_;  ///< scratch
  std::size_t known_ = 0;             ///< length of ids_ when it was last sorted
  bool ascends_ = true;               ///< what was noted since is in ascending order
};

}  // namespace aurasim::physics
