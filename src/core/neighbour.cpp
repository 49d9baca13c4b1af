#include "core/neighbour.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace aurasim::core {
namespace {

/// The gate asks for a stamp at most this far behind the newest batch in effect.
constexpr Step kGateHistory = 64;

/// More words than nodes ever say in one state: two, and one for each hop across the map.
constexpr std::size_t kMostWords = 256;

bool by_id(const AuraRecord& a, const AuraRecord& b) { return a.id < b.id; }

}  // namespace

bool Neighbour::accept(AuraBatch batch) {
  if (batch.stamp <= received_) return false;
  const auto place = std::ranges::lower_bound(waiting_, batch.stamp, {}, &AuraBatch::stamp);
  if (place != waiting_.end() && place->stamp == batch.stamp) return false;
  waiting_.insert(place, std::move(batch));
  auto next = std::ranges::upper_bound(waiting_, received_, {}, &AuraBatch::stamp);
  for (; next != waiting_.end() && next->stamp == received_ + 1; ++next) {
    note_marks(*next);
    ++received_;
  }
  return true;
}

bool Neighbour::accept_word(AuraBatch word) {
  const Step newest = words_.empty() ? word.stamp : words_.front().stamp;
  if (word.stamp < newest || this->word(word.stamp, word.word) != nullptr || words_.size() >= kMostWords) return false;
  if (word.stamp > newest) words_.clear();
  words_.push_back(std::move(word));
  return true;
}

const AuraBatch* Neighbour::word(Step stamp, std::uint32_t number) const {
  const auto found =
      std::ranges::find_if(words_, [&](const AuraBatch& word) { return word.stamp == stamp && word.word == number; });
  return found == words_.end() ? nullptr : &*found;
}

bool Neighbour::announces_redo() const {
  const auto is_redo = [](const Order& order) { return std::holds_alternative<Redo>(order.action); };
  return std::ranges::any_of(waiting_, [&](const AuraBatch& batch) {
    return !batch.alarms.empty() || std::ranges::any_of(batch.orders, is_redo);
  });
}

void Neighbour::note_marks(const AuraBatch& batch) {
  for (const HandOffMark& mark : batch.hand_offs) {
    if (mark.destination == self_) marks_.push_back({batch.stamp, mark.last_sequence});
  }
}

void Neighbour::apply(AuraBatch& batch) {
  applied_ = batch.stamp;
  while (marks_.size() > 1 && marks_[1].stamp < applied_ - kGateHistory) marks_.erase(marks_.begin());
  top_speed_m_s_ = batch.top_speed_m_s;
  top_radius_m_ = batch.top_radius_m;
  violations_ = batch.violations;
  if (batch.full) auras_.clear();
  orders_.insert(orders_.end(), batch.orders.begin(), batch.orders.end());
  alarms_.insert(alarms_.end(), batch.alarms.begin(), batch.alarms.end());
  for (const Introduction& pair : batch.introductions) introductions_.push_back({batch.stamp, pair, batch.source});
  past_ = std::move(batch.past);
  merge(batch);
}

void Neighbour::merge(AuraBatch& batch) {
  if (batch.updates.empty() && batch.deletes.empty()) return;
  if (!std::ranges::is_sorted(batch.updates, by_id)) std::ranges::stable_sort(batch.updates, by_id);
  std::sort(batch.deletes.begin(), batch.deletes.end());
  merged_.clear();
  auto old = auras_.begin();
  auto gone = batch.deletes.begin();
  const auto keep = [&](const AuraRecord& aura) {
    while (gone != batch.deletes.end() && *gone < aura.id) ++gone;
    if (gone == batch.deletes.end() || *gone != aura.id) merged_.push_back(aura);
  };
  const Audience self = audience_of(self_);
  for (const AuraRecord& update : batch.updates) {
    for (; old != auras_.end() && old->id < update.id; ++old) keep(*old);
    if (old != auras_.end() && old->id == update.id) ++old;
    if (update.audience & self) merged_.push_back(update);
  }
  for (; old != auras_.end(); ++old) keep(*old);
  std::swap(auras_, merged_);
}

std::uint64_t Neighbour::hand_offs_until(Step stamp) const {
  std::uint64_t last = 0;
  for (const Mark& mark : marks_) {
    if (mark.stamp <= stamp) last = std::max(last, mark.last_sequence);
  }
  return last;
}

std::vector<Order> Neighbour::take_orders() { return std::exchange(orders_, {}); }

std::vector<Alarm> Neighbour::take_alarms() { return std::exchange(alarms_, {}); }

std::vector<Neighbour::Introduced> Neighbour::take_introductions() { return std::exchange(introductions_, {}); }

void Neighbour::mark_dead() {
  alive_ = false;
  auras_.clear();
  waiting_.clear();
}

}  // namespace aurasim::core
