#include "core/static_moves.h"

#include <algorithm>

namespace aurasim::core {

void StaticMoves::add(const MoveStatic& move, Step at_step) {
  std::vector<Move>& moves = moves_[move.id];
  moves.insert(std::ranges::upper_bound(moves, at_step, {}, &Move::at_step), {at_step, move});
}

Pose StaticMoves::pose(const StaticBody& body, StaticId id, Step step, double step_s) const {
  const auto known = moves_.find(id);
  if (known != moves_.end()) {
    const auto later = std::ranges::upper_bound(known->second, step, {}, &Move::at_step);
    if (later != known->second.begin()) {
      const auto& [at_step, move] = *(later - 1);
      if (step + 1 >= at_step + move.states) return move.to;
      return pose_between(move.from, move.to,
                          static_cast<double>(step + 1 - at_step) / static_cast<double>(move.states));
    }
  }
  return pose_at(body, static_cast<double>(step) * step_s);
}

Step StaticMoves::newest(StaticId id) const {
  const auto known = moves_.find(id);
  return known == moves_.end() ? 0 : known->second.back().at_step;
}

void StaticMoves::forget_before(Step step) {
  for (auto& [id, moves] : moves_) {
    const auto later = std::ranges::upper_bound(moves, step, {}, &Move::at_step);
    if (later - moves.begin() > 1) moves.erase(moves.begin(), later - 1);
  }
}

void forget_moves_before(Step step, std::vector<Order>& orders) {
  std::map<StaticId, std::uint64_t> newest;  // sequence of the one that is in effect then
  for (const Order& order : orders) {
    const auto* const move = std::get_if<MoveStatic>(&order.action);
    if (move != nullptr && order.at_step < step) newest[move->id] = order.sequence;
  }
  std::erase_if(orders, [&](const Order& order) {
    const auto* const move = std::get_if<MoveStatic>(&order.action);
    return move != nullptr && order.at_step < step && order.sequence != newest.at(move->id);
  });
}

}  // namespace aurasim::core
