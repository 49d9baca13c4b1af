// Where statics are that have been told to move, and those that their scene moves (core/static_path.h). What is ordered
// (MoveStatic) is certain; what a program has said (core/setpoint.h) is expected until its order is here
// (docs/decisions/0030-a-word-before-its-order.md).
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "core/ids.h"
#include "core/order.h"
#include "core/scene.h"
#include "core/setpoint.h"
#include "core/static_path.h"

namespace aurasim::core {

class StaticMoves {
 public:
  /// Ordered: takes effect from state `at_step` on. Of the orders about one static those that come later begin no
  /// earlier. Returns the first state that is another one by it: nothing where it was expected as it is.
  std::optional<Step> add(const MoveStatic& move, Step at_step, std::uint64_t request);
  /// Said: takes effect as if its order were here, unless it is.
  void expect(const MoveStatic& move, Step at_step, std::uint64_t request);
  /// What was expected for states before this one has not been ordered, and does not count. Returns the first state
  /// that is another one by it.
  std::optional<Step> give_up_expected(Step before);

  /// In a state; states are step_s apart.
  Pose pose(const StaticBody& body, StaticId id, Step step, double step_s) const;
  /// Where its newest move begins; 0: it has none.
  Step newest(StaticId id) const;
  /// visit(id), ascending, for those that have been told to move.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& [id, moves] : moves_) visit(id);
  }
  /// visit(move) for those that begin in a state, ascending id.
  template <class Visit>
  void for_each_from(Step step, Visit&& visit) const {
    for (const auto& [id, moves] : moves_) {
      for (const Move& one : std::ranges::equal_range(moves, step, {}, &Move::at_step)) visit(one.move);
    }
  }
  /// Of one static, without what is only expected: what says where it is from before its newest order on.
  StaticMoves ordered(StaticId id) const;
  /// Of states before this one nobody asks.
  void forget_before(Step step);

 private:
  struct Move {
    Step at_step = 0;
    MoveStatic move;
    std::uint64_t request = 0;
    bool is_ordered = false;
  };
  void insert(Move move);

  std::map<StaticId, std::vector<Move>> moves_;  ///< each ascending at_step
  std::size_t expected_ = 0;
};

/// Can an order say it? Its place is not too far out, its rotation of length 1, and it is there some time.
bool is_sound(const StaticSetpoint& wanted);

struct PlannedMove {
  Step at_step = 0;
  MoveStatic move;
};
/// What is wanted of a static, after the moves that are known: no earlier than the newest of them, from where it is by
/// then, and no faster than a static may be.
PlannedMove planned(const StaticSetpoint& wanted, Step at_step, const StaticMoves& known, const StaticBody& body,
                    double step_s);

/// From the orders of a run: the moves that are over before `step`, and that later ones of the same static have
/// replaced. Nobody who joins has to know of them.
void forget_moves_before(Step step, std::vector<Order>& orders);

}  // namespace aurasim::core
