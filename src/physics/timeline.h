// Orders and setpoints of a world by the state in which they take effect. Shared by a region's world and the scratch
// world, so that both apply them alike.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/control_log.h"
#include "core/order.h"
#include "core/static_moves.h"

namespace aurasim::physics {

class Timeline {
 public:
  /// Adds an order about a static or a body; others are ignored. For a MoveStatic, returns the first state that it
  /// changes (StaticMoves::add).
  std::optional<core::Step> add(const core::Order& order);

  /// Does a static exist while state `step` is computed, and in that state?
  bool stands(std::uint32_t static_index, core::Step step) const;
  /// Is there any static that is added or removed at some time?
  bool statics_change() const { return !lives_.empty(); }
  /// The statics that are added or removed at some time. Ascending.
  std::vector<std::uint32_t> changing_statics() const;

  /// Orders about bodies to be executed just before state `step` is computed, in sequence.
  std::span<const core::Order> due(core::Step step) const;
  /// Orders about bodies that are due later than `step`.
  std::span<const core::Order> coming(core::Step step) const;

  const core::StaticMoves& moves() const { return moves_; }
  core::StaticMoves& moves() { return moves_; }

  /// Statics that are added or removed later than `step`.
  std::vector<std::uint32_t> statics_coming(core::Step step) const;

  void forget_before(core::Step step);

  const core::ControlLog& controls() const { return controls_; }
  core::ControlLog& controls() { return controls_; }

 private:
  struct Life {
    std::uint32_t index = 0;
    core::Step from = std::numeric_limits<core::Step>::min();
    core::Step until = std::numeric_limits<core::Step>::max();
  };
  Life& life_of(std::uint32_t index);

  std::vector<Life> lives_;          ///< statics that are added or removed, ascending index
  std::vector<core::Order> orders_;  ///< ascending (at_step, sequence)
  core::StaticMoves moves_;
  core::ControlLog controls_;
};

}  // namespace aurasim::physics
