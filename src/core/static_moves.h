// Poses of statics that orders or programs move, or whose scene moves them (core/static_path.h). A move that is ordered
// (MoveStatic) is certain. One that a program has sent (core/setpoint.h) is expected until its order has been received
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
  /// Adds an ordered move, in effect from state `at_step` on. Later orders about the same static begin no earlier.
  /// Returns the first state that it changes; nothing where the move was expected just so.
  std::optional<Step> add(const MoveStatic& move, Step at_step, std::uint64_t request);
  /// Adds the move of a program's message. It takes effect as if it were ordered; ignored if its order has been
  /// received.
  void expect(const MoveStatic& move, Step at_step, std::uint64_t request);
  /// Drops moves that were expected for states before `before` and have not been ordered. Returns the first state that
  /// this changes.
  std::optional<Step> give_up_expected(Step before);

  /// Pose of the static in state `step`; states are step_s apart.
  Pose pose(const StaticBody& body, StaticId id, Step step, double step_s) const;
  /// The same, of a static of `statics`.
  Pose pose(const StaticList& statics, StaticId id, Step step, double step_s) const;
  /// State in which the newest move of a static begins; 0 if it has none.
  Step newest(StaticId id) const;
  /// Calls visit(id), ascending, for each static that has moves.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& [id, moves] : moves_) visit(id);
  }
  /// Calls visit(move) for each move that begins in state `step`, ascending id.
  template <class Visit>
  void for_each_from(Step step, Visit&& visit) const {
    for (const auto& [id, moves] : moves_) {
      for (const Move& one : std::ranges::equal_range(moves, step, {}, &Move::at_step)) visit(one.move);
    }
  }
  /// The ordered moves of one static: those that decide its pose from just before its newest order on.
  StaticMoves ordered(StaticId id) const;
  /// States before `step` are not asked for any more.
  void forget_before(Step step);

 private:
  struct Move {
    Step at_step = 0;
    MoveStatic move;
    std::uint64_t request = 0;
    bool is_ordered = false;
  };
  void insert(Move move);
  std::optional<Pose> moved(StaticId id, Step step) const;

  std::map<StaticId, std::vector<Move>> moves_;  ///< by static, ascending at_step
  std::size_t expected_ = 0;
};

/// Can the setpoint become an order? Its place is not too far out, its rotation has length 1, and its number of states
/// is in range.
bool is_sound(const StaticSetpoint& wanted);

struct PlannedMove {
  Step at_step = 0;
  MoveStatic move;
};
/// The move that a setpoint becomes, given the known moves: it begins no earlier than the newest of them, from the pose
/// by then, and is no faster than a static may be.
PlannedMove planned(const StaticSetpoint& wanted, Step at_step, const StaticMoves& known, const StaticBody& body,
                    double step_s);

/// Removes from `orders` the moves of statics before `step` that later moves of the same static have replaced.
void forget_moves_before(Step step, std::vector<Order>& orders);

}  // namespace aurasim::core
