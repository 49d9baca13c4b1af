// What orders and programs do to a world, and when: shared by a region's world and the scratch world in which late
// bodies make up steps, so that both apply them alike.
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
  /// Statics and orders about bodies; others are nothing to physics. Of a static that is to move: the first state that
  /// is another one by it (StaticMoves::add).
  std::optional<core::Step> add(const core::Order& order);

  /// Is a static in the world while state `step` is computed, and in it?
  bool stands(std::uint32_t static_index, core::Step step) const;
  /// Any static that does not stand for ever?
  bool statics_change() const { return !lives_.empty(); }

  /// Orders about bodies that are applied before state `step` is computed, in sequence.
  std::span<const core::Order> due(core::Step step) const;
  /// Those due later than `step`.
  std::span<const core::Order> coming(core::Step step) const;

  const core::StaticMoves& moves() const { return moves_; }
  core::StaticMoves& moves() { return moves_; }

  /// Statics that come or go later than `step`.
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

  std::vector<Life> lives_;          ///< of statics that come or go, ascending index
  std::vector<core::Order> orders_;  ///< ascending (at_step, sequence)
  core::StaticMoves moves_;
  core::ControlLog controls_;
};

}  // namespace aurasim::physics
