#include "physics/timeline.h"

#include <algorithm>
#include <tuple>

namespace aurasim::physics {
namespace {

bool earlier(const core::Order& a, const core::Order& b) {
  return std::tie(a.at_step, a.sequence) < std::tie(b.at_step, b.sequence);
}

}  // namespace

Timeline::Life& Timeline::life_of(std::uint32_t index) {
  const auto place = std::lower_bound(lives_.begin(), lives_.end(), index,
                                      [](const Life& life, std::uint32_t wanted) { return life.index < wanted; });
  if (place != lives_.end() && place->index == index) return *place;
  Life life;
  life.index = index;
  return *lives_.insert(place, life);
}

std::optional<core::Step> Timeline::add(const core::Order& order) {
  if (const auto* added = std::get_if<core::AddStatic>(&order.action)) {
    life_of(core::value_of(added->id)).from = order.at_step;
  } else if (const auto* removed = std::get_if<core::RemoveStatic>(&order.action)) {
    Life& life = life_of(core::value_of(removed->id));
    life.until = std::min(life.until, order.at_step);
  } else if (const auto* moved = std::get_if<core::MoveStatic>(&order.action)) {
    return moves_.add(*moved, order.at_step, order.request);
  } else if (core::body_of(order.action)) {
    orders_.insert(std::upper_bound(orders_.begin(), orders_.end(), order, earlier), order);
  }
  return std::nullopt;
}

bool Timeline::stands(std::uint32_t static_index, core::Step step) const {
  const auto place = std::lower_bound(lives_.begin(), lives_.end(), static_index,
                                      [](const Life& life, std::uint32_t wanted) { return life.index < wanted; });
  if (place == lives_.end() || place->index != static_index) return true;
  return place->from <= step && step < place->until;
}

std::span<const core::Order> Timeline::due(core::Step step) const {
  core::Order key;
  key.at_step = step;
  const auto first = std::lower_bound(orders_.begin(), orders_.end(), key, earlier);
  key.at_step = step + 1;
  return {first, std::lower_bound(first, orders_.end(), key, earlier)};
}

std::span<const core::Order> Timeline::coming(core::Step step) const {
  core::Order key;
  key.at_step = step + 1;
  return {std::lower_bound(orders_.begin(), orders_.end(), key, earlier), orders_.end()};
}

std::vector<std::uint32_t> Timeline::changing_statics() const {
  std::vector<std::uint32_t> changing;
  for (const Life& life : lives_) changing.push_back(life.index);
  return changing;
}

std::vector<std::uint32_t> Timeline::statics_coming(core::Step step) const {
  constexpr core::Step kEver = std::numeric_limits<core::Step>::max();
  std::vector<std::uint32_t> changing;
  for (const Life& life : lives_) {
    if (life.from > step || (life.until > step && life.until != kEver)) changing.push_back(life.index);
  }
  return changing;
}

void Timeline::forget_before(core::Step step) {
  std::erase_if(orders_, [step](const core::Order& order) { return order.at_step < step; });
  moves_.forget_before(step);
}

}  // namespace aurasim::physics
