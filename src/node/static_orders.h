// Which moves of statics become orders, and whether nodes go by the setpoints that they receive before the orders come
// (docs/decisions/0030-a-word-before-its-order.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/setpoint.h"

namespace aurasim::node {

/// Request number of the order for a static's setpoint. It is the same on every node.
std::uint64_t request_of(const core::Setpoints& said, core::StaticId id);
std::uint64_t request_of(const core::StaticEffect& recorded);

class StaticOrders {
 public:
  /// `recorded`: setpoints of an earlier run. Their moves of statics are repeated.
  explicit StaticOrders(const std::vector<core::Setpoints>& recorded);

  /// The recorded moves, ascending by state.
  std::span<const core::StaticEffect> recorded() const { return recorded_; }
  /// The next recorded move that takes effect up to state `until`; null if there is none. pass() goes on to the one
  /// after it.
  const core::StaticEffect* next_recorded(core::Step until) const;
  void pass() { ++next_recorded_; }

  /// Counts one more order given in state `now`. False if that are too many.
  bool may_order(core::Step now);

  /// Notes that the run has gone back from state `from`, because a static was elsewhere than ordered.
  void note_doubt(core::Step from) { doubted_.push_back(from); }
  /// False if the run went back for that reason too often lately. Then all nodes wait for orders.
  bool are_believed(core::Step now) const;

 private:
  std::vector<core::StaticEffect> recorded_;
  std::size_t next_recorded_ = 0;
  core::Step ordered_for_ = -1;  ///< the state in which ordered_ orders have been given
  std::size_t ordered_ = 0;
  std::vector<core::Step> doubted_;
};

/// Messages of programs that came after their state had been computed.
class LateWords {
 public:
  struct Word {
    core::Step at_step = 0;  ///< the state that the message named
    core::Step heard = 0;    ///< the newest state when it was received
  };

  void note(core::Step at_step, core::Step heard);
  /// The setpoints that another node may have received at another time, so that it computes another world when the
  /// states from `from` to `until` are computed again.
  std::vector<Word> that_matter(core::Step from, core::Step until) const;

 private:
  std::vector<Word> words_;  ///< the last ones
};

}  // namespace aurasim::node
