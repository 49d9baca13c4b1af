#include "core/neighbour.h"

#include <algorithm>
#include <utility>

namespace aurasim::core {
namespace {

/// The gate asks for a stamp at most this far behind the newest batch in effect.
constexpr Step kGateHistory = 64;

/// More words than nodes ever say in one state: two, and one for each hop across the map.
constexpr std::size_t kMostWords = 256;

}  // namespace

bool Neighbour::accept(AuraBatch batch, const Arrived& arrived) {
  if (batch.stamp <= received_) return false;
  const auto place = std::ranges::lower_bound(waiting_, batch.stamp, {}, &AuraBatch::stamp);
  if (place != waiting_.end() && place->stamp == batch.stamp) return false;
  PublishedAuras::sort(batch);
  waiting_.insert(place, std::move(batch));
  auto next = std::ranges::upper_bound(waiting_, received_, {}, &AuraBatch::stamp);
  for (; next != waiting_.end() && next->stamp == received_ + 1; ++next) {
    ++received_;
    note_arrival(*next);
    if (!arrived) continue;
    arrived_.merge(*next);
    past_ = next->past;
    arrived(*this);
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

bool Neighbour::note_gathered(const AuraBatch& word) {
  if (has_gathered_) return false;
  has_gathered_ = true;
  note_marks(word);
  return true;
}

void Neighbour::note_marks(const AuraBatch& batch) {
  for (const HandOffMark& mark : batch.hand_offs) {
    if (mark.region == self_) marks_.push_back({batch.stamp, mark.last_sequence});
  }
}

/// Orders and alarms count as soon as they arrive: they name states themselves.
void Neighbour::note_arrival(const AuraBatch& batch) {
  note_marks(batch);
  orders_.insert(orders_.end(), batch.orders.begin(), batch.orders.end());
  alarms_.insert(alarms_.end(), batch.alarms.begin(), batch.alarms.end());
}

void Neighbour::apply_until(Step last) {
  last = std::min(last, received_);
  auto due_end = waiting_.begin();
  for (; due_end != waiting_.end() && due_end->stamp <= last; ++due_end) apply(*due_end);
  waiting_.erase(waiting_.begin(), due_end);
}

void Neighbour::apply(const AuraBatch& batch) {
  applied_ = batch.stamp;
  while (marks_.size() > 1 && marks_[1].stamp < applied_ - kGateHistory) marks_.erase(marks_.begin());
  top_speed_m_s_ = batch.top_speed_m_s;
  top_radius_m_ = batch.top_radius_m;
  violations_ = batch.violations;
  for (const Introduction& pair : batch.introductions) introductions_.push_back({batch.stamp, pair, batch.source});
  in_effect_.merge(batch);
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
  in_effect_ = arrived_ = PublishedAuras(self_);
  waiting_.clear();
}

}  // namespace aurasim::core
