// Where statics are that have been told to move (MoveStatic), and those that their scene moves (core/static_path.h).
#pragma once

#include <map>
#include <vector>

#include "core/ids.h"
#include "core/order.h"
#include "core/scene.h"
#include "core/static_path.h"

namespace aurasim::core {

class StaticMoves {
 public:
  /// Takes effect from state `at_step` on. Of the moves of one static those that come later begin no earlier.
  void add(const MoveStatic& move, Step at_step);

  /// In a state; states are step_s apart.
  Pose pose(const StaticBody& body, StaticId id, Step step, double step_s) const;
  /// Where its newest move begins; 0: it has none.
  Step newest(StaticId id) const;
  /// visit(id), ascending, for those that have been told to move.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& [id, moves] : moves_) visit(id);
  }
  /// Of states before this one nobody asks.
  void forget_before(Step step);

 private:
  struct Move {
    Step at_step;
    MoveStatic move;
  };
  std::map<StaticId, std::vector<Move>> moves_;  ///< each ascending
};

/// From the orders of a run: the moves that are over before `step`, and that later ones of the same static have
/// replaced. Nobody who joins has to know of them.
void forget_moves_before(Step step, std::vector<Order>& orders);

}  // namespace aurasim::core
