// Bodies that a step has moved so that something has to be done about them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "physics/body_table.h"
#include "physics/changed_bodies.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {

/// Each body that has changed is looked at once for all questions, by all threads, because the bodies are scattered in
/// memory.
class Findings {
 public:
  /// Bits.
  enum What : std::uint8_t {
    kBroken = 1,     ///< has_broken_down() (physics/breakdown.h)
    kLeftBlock = 2,  ///< it is awake, has a block of its own, and is beyond the block's margin (core/block.h)
  };

  /// Looks at all changed bodies. `block_m`: side of a block, m.
  void look(BodyTable& table, ChangedBodies& changed, double block_m, soft::Team& team);
  /// Bodies have changed since, or have come or gone.
  void forget() { are_fresh_ = false; }

  /// Calls visit(body) for each changed body of which `what` is true, in the order of the table.
  template <class Visit>
  void for_each(What what, BodyTable& table, ChangedBodies& changed, double block_m, Visit&& visit) const {
    if (are_fresh_) {
      for (std::size_t i = 0; i < places_.size(); ++i) {
        if ((found_[i] & what) != 0) visit(table[places_[i]]);
      }
    } else {
      changed.for_each(table, [&](const HostedBody& body, std::size_t) {
        if ((find(body, block_m) & what) != 0) visit(body);
      });
    }
  }

  /// Frees the memory that many changed bodies have used.
  void free_spare_memory() { *this = {}; }

 private:
  static std::uint8_t find(const HostedBody& body, double block_m);

  bool are_fresh_ = false;
  std::vector<std::uint32_t> places_;  ///< of the changed bodies in the table, ascending
  std::vector<std::uint8_t> found_;    ///< by index in places_
};

}  // namespace aurasim::physics
