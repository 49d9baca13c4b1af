// Orders about the run as a whole: another scene, another world, other regions. Knows which wait for their state, which
// is due, and what to go back to if a change fails. Uses no DDS and no clock.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "config/launch.h"
#include "core/order.h"
#include "core/world_cut.h"
#include "messages/control_messages.h"

namespace aurasim::process {

/// True if all nodes wait in state `step`, the state of a change, or have begun a later generation. No node may close
/// its transport earlier, because its messages may have to be retransmitted. The node of region `self` does not count.
bool all_wait_in(const std::map<core::RegionId, messages::SeenStatus>& nodes, core::RegionId self,
                 core::Generation generation, core::Step step);

class RunChanges {
 public:
  /// The launch and world that a change replaces, to be put back if it fails.
  struct Before {
    config::Launch launch;
    std::shared_ptr<const core::WorldCut> world;  ///< saved world that the run began with
  };

  /// Adds the orders that have been received in a step.
  void add(std::span<const core::Order> orders) { waiting_.insert(waiting_.end(), orders.begin(), orders.end()); }
  /// A world begins. Orders of the one before are void, except a change that is due.
  void begin_world() { waiting_.clear(); }
  /// States after which the run changes. The node keeps them.
  std::vector<core::Step> states_to_keep() const;
  /// True if the state of a change has been computed and is not confirmed yet. An order given now would not reach all
  /// nodes before they stop for the change.
  bool is_about_to_change(core::Step current) const;
  /// Removes the orders whose state has been computed. Returns the states of those that change the run; the last of
  /// them is due. A change needs its state to be confirmed.
  std::vector<core::Step> take_reached(core::Step current, core::Step confirmed);

  bool is_due() const { return due_.has_value(); }
  /// Begins the change that is due. `before`: what it replaces. Precondition: is_due().
  core::Order begin(Before before);
  /// The change has succeeded.
  void finish();
  /// The change has failed. True if it may be tried again: it has not failed too often in a row.
  bool may_try_again();
  /// A recovery begins. Drops all orders, and returns what a change under way has replaced. Its client asks again.
  std::optional<Before> drop();

 private:
  std::vector<core::Order> waiting_;
  std::optional<core::Order> due_;
  std::optional<Before> before_;  ///< set while a change is under way
  int failed_ = 0;                ///< in a row
};

}  // namespace aurasim::process
