#include "core/static_moves.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/limits.h"

namespace aurasim::core {
namespace {

bool same_pose(const Pose& x, const Pose& y) { return x.p_WB == y.p_WB && x.q_WB.coeffs() == y.q_WB.coeffs(); }

bool same_move(const MoveStatic& x, const MoveStatic& y) {
  return x.states == y.states && same_pose(x.from, y.from) && same_pose(x.to, y.to);
}

std::optional<Step> earlier_of(std::optional<Step> a, std::optional<Step> b) {
  return a && b ? std::min(a, b) : a ? a : b;
}

}  // namespace

void StaticMoves::insert(Move move) {
  std::vector<Move>& moves = moves_[move.move.id];
  expected_ += move.is_ordered ? 0 : 1;
  moves.insert(std::ranges::upper_bound(moves, move.at_step, {}, &Move::at_step), std::move(move));
}

std::optional<Step> StaticMoves::add(const MoveStatic& move, Step at_step, std::uint64_t request) {
  std::optional<Step> changed;
  if (expected_ > 0) {
    std::vector<Move>& moves = moves_[move.id];
    const auto said =
        std::ranges::find_if(moves, [&](const Move& one) { return !one.is_ordered && one.request == request; });
    if (said != moves.end()) {
      --expected_;
      said->is_ordered = true;
      if (said->at_step == at_step && same_move(said->move, move)) return std::nullopt;
      changed = said->at_step;
      moves.erase(said);
    }
  }
  insert({at_step, move, request, true});
  return earlier_of(changed, at_step);
}

void StaticMoves::expect(const MoveStatic& move, Step at_step, std::uint64_t request) {
  const auto known = moves_.find(move.id);
  const bool is_here =
      known != moves_.end() && std::ranges::find(known->second, request, &Move::request) != known->second.end();
  if (!is_here) insert({at_step, move, request, false});
}

std::optional<Step> StaticMoves::give_up_expected(Step before) {
  std::optional<Step> first;
  if (expected_ == 0) return first;
  for (auto& [id, moves] : moves_) {
    std::erase_if(moves, [&](const Move& one) {
      if (one.is_ordered || one.at_step >= before) return false;
      first = earlier_of(first, one.at_step);
      --expected_;
      return true;
    });
  }
  std::erase_if(moves_, [](const auto& of_static) { return of_static.second.empty(); });
  return first;
}

StaticMoves StaticMoves::ordered(StaticId id) const {
  StaticMoves certain;
  const auto known = moves_.find(id);
  if (known == moves_.end()) return certain;
  std::vector<Move> ends;  // ordered moves of the static, newest first
  for (auto one = known->second.rbegin(); one != known->second.rend(); ++one) {
    if (!one->is_ordered) continue;
    ends.push_back(*one);
    if (one->at_step < ends.front().at_step) break;
  }
  if (!ends.empty()) certain.moves_[id].assign(ends.rbegin(), ends.rend());
  return certain;
}

/// The pose to which moves have brought a static; nothing if it has not been moved by this state.
std::optional<Pose> StaticMoves::moved(StaticId id, Step step) const {
  const auto known = moves_.find(id);
  if (known == moves_.end()) return std::nullopt;
  const auto later = std::ranges::upper_bound(known->second, step, {}, &Move::at_step);
  if (later == known->second.begin()) return std::nullopt;
  const Move& newest = *(later - 1);
  const MoveStatic& move = newest.move;
  if (step + 1 >= newest.at_step + move.states) return move.to;
  return pose_between(move.from, move.to,
                      static_cast<double>(step + 1 - newest.at_step) / static_cast<double>(move.states));
}

Pose StaticMoves::pose(const StaticBody& body, StaticId id, Step step, double step_s) const {
  if (const std::optional<Pose> pose = moved(id, step)) return *pose;
  return pose_at(body, static_cast<double>(step) * step_s);
}

Pose StaticMoves::pose(const StaticList& statics, StaticId id, Step step, double step_s) const {
  if (const std::optional<Pose> pose = moved(id, step)) return *pose;
  const std::uint32_t index = value_of(id);
  return statics.moves(index) ? pose_at(statics[index], static_cast<double>(step) * step_s) : statics.pose(index);
}

Step StaticMoves::newest(StaticId id) const {
  const auto known = moves_.find(id);
  return known == moves_.end() ? 0 : known->second.back().at_step;
}

void StaticMoves::forget_before(Step step) {
  for (auto& [id, moves] : moves_) {
    const auto later = std::ranges::upper_bound(moves, step, {}, &Move::at_step);
    if (later - moves.begin() <= 1) continue;
    expected_ -= static_cast<std::size_t>(
        std::count_if(moves.begin(), later - 1, [](const Move& one) { return !one.is_ordered; }));
    moves.erase(moves.begin(), later - 1);
  }
}

bool is_sound(const StaticSetpoint& wanted) {
  constexpr double kMostOff = 1e-6;  // order_columns.cpp
  return wanted.to.p_WB.cwiseAbs().maxCoeff() <= limits::kFarthestPlace_m &&
         std::abs(wanted.to.q_WB.norm() - 1) <= kMostOff && wanted.states >= 1 &&
         wanted.states <= limits::kMostStepsAhead;
}

PlannedMove planned(const StaticSetpoint& wanted, Step at_step, const StaticMoves& known, const StaticBody& body,
                    double step_s) {
  const Step from_then = std::max(at_step, known.newest(wanted.id));
  MoveStatic move{wanted.id, known.pose(body, wanted.id, from_then - 1, step_s), wanted.to, wanted.states};
  const Twist at_once = twist_between(move.from, move.to, step_s);
  const double states =
      std::max(at_once.v_W.norm() / limits::kFastestStatic_m_s, at_once.w_W.norm() / limits::kFastestStatic_rad_s);
  move.states = std::max(move.states, static_cast<Step>(std::ceil(states)));
  return {from_then, move};
}

void forget_moves_before(Step step, std::vector<Order>& orders) {
  std::map<StaticId, std::uint64_t> newest;  // by static: sequence of its newest move before `step`
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
