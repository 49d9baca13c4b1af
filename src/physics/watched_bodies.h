// The bodies that a coupled region looks at in each step: those that are awake, guests, and those near its borders. A
// sleeper far from all borders costs nothing.
#pragma once

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "physics/body_table.h"
#include "physics/changed_bodies.h"

namespace aurasim::physics {

/// Named by id, because places in the table change when bodies come or go. Nothing is allocated once warm.
class WatchedBodies {
 public:
  /// Adds the bodies that may have changed since the last call.
  void add(ChangedBodies& changed, const BodyTable& table) {
    if (changed.all()) {
      ids_.clear();
      for (const HostedBody& body : table.bodies()) ids_.push_back(body.id);
    } else if (changed.most() > 0) {
      merged_.clear();
      std::ranges::set_union(ids_, changed.ids(), std::back_inserter(merged_));
      std::swap(ids_, merged_);
    }
    changed.clear();
  }

  /// Drops the bodies that have left the table, and those for which `stays(body)` is false: until they change.
  template <class Stays>
  void keep(const BodyTable& table, Stays&& stays) {
    std::size_t near = 0;
    std::erase_if(ids_, [&](core::BodyId id) {
      const HostedBody* const body = table.find(id, near);
      return body == nullptr || !stays(*body);
    });
  }

  /// Calls visit(body) for each that is in the table, in ascending order.
  template <class Visit>
  void for_each(const BodyTable& table, Visit&& visit) const {
    std::size_t near = 0;
    for (const core::BodyId id : ids_) {
      if (const HostedBody* const body = table.find(id, near)) visit(*body);
    }
  }

 private:
  std::vector<core::BodyId> ids_;     ///< ascending
  std::vector<core::BodyId> merged_;  ///< scratch
};

}  // namespace aurasim::physics
