#include "core/setpoint_history.h"

#include <iterator>
#include <utility>

#include "core/setpoint.h"

namespace aurasim::core {
namespace {

/// Each forget_before() tests one of so many parts of the rows for setpoints that are over.
constexpr std::size_t kParts = 30;

/// Sorts by key, and keeps the last of several entries with one key.
template <class List>
void put_in_order(List& said) {
  const auto key_of = &List::value_type::key;
  if (std::ranges::adjacent_find(said, std::ranges::greater_equal{}, key_of) == said.end()) return;
  std::ranges::reverse(said);
  std::ranges::stable_sort(said, {}, key_of);
  const auto rest = std::ranges::unique(said, {}, key_of);
  said.erase(rest.begin(), rest.end());
}

/// Erases rows with is_over(row) in one part of `rows`, which begins at `next`. Moves `next` to the following part.
template <class Rows, class IsOver>
void erase_part(Rows& rows, std::size_t& next, const IsOver& is_over) {
  if (next >= rows.size()) next = 0;
  const auto first = rows.begin() + static_cast<std::ptrdiff_t>(next);
  const auto last = first + static_cast<std::ptrdiff_t>(std::min(rows.size() - next, rows.size() / kParts + 1));
  const auto rest = std::remove_if(first, last, is_over);
  next = static_cast<std::size_t>(rest - rows.begin());
  rows.erase(rest, last);
}

}  // namespace

template <class Key, class Value>
void SetpointHistory<Key, Value>::add(const MessageStamp& stamp, std::vector<Said> said) {
  if (said.empty()) return;
  put_in_order(said);
  if (stamp.from <= asked_) put(newest_, stamp, said);
  auto place = messages_.begin() + (later_than(stamp.from) - messages_.cbegin());
  while (place != messages_.begin() && (place - 1)->stamp >= stamp) --place;
  if (place == messages_.end() || place->stamp != stamp) {
    said_ += said.size();
    messages_.insert(place, {stamp, std::move(said)});
    return;
  }
  said_ -= place->said.size();
  std::ranges::move(said, std::back_inserter(place->said));
  put_in_order(place->said);
  said_ += place->said.size();
}

template <class Key, class Value>
void SetpointHistory<Key, Value>::put(Rows& rows, const MessageStamp& stamp, const std::vector<Said>& said) {
  Rows missing;
  std::size_t place = 0;
  for (const Said& one : said) {
    if (place == rows.size() || rows[place].key != one.key) {
      const auto from = rows.begin() + static_cast<std::ptrdiff_t>(place);
      place =
          static_cast<std::size_t>(std::ranges::lower_bound(from, rows.end(), one.key, {}, &Held::key) - rows.begin());
    }
    if (place == rows.size() || rows[place].key != one.key) {
      missing.push_back({one.key, stamp, one.value});
    } else if (Held& row = rows[place++]; row.stamp <= stamp) {
      row.stamp = stamp;
      row.value = one.value;
    }
  }
  if (missing.empty()) return;
  const auto old_size = static_cast<std::ptrdiff_t>(rows.size());
  std::ranges::move(missing, std::back_inserter(rows));
  std::ranges::inplace_merge(rows, rows.begin() + old_size, {}, &Held::key);
}

template <class Key, class Value>
void SetpointHistory<Key, Value>::go_to(Step step) const {
  if (step <= asked_) return;
  for (auto message = later_than(asked_); message != messages_.end() && message->stamp.from <= step; ++message) {
    put(newest_, message->stamp, message->said);
  }
  asked_ = step;
}

template <class Key, class Value>
auto SetpointHistory<Key, Value>::before(const Key& key, typename Messages::const_iterator later) const
    -> std::optional<Held> {
  while (later != messages_.begin()) {
    --later;
    const auto said = std::ranges::lower_bound(later->said, key, {}, &Said::key);
    if (said != later->said.end() && said->key == key) return Held{key, later->stamp, said->value};
  }
  const auto held = std::ranges::lower_bound(held_, key, {}, &Held::key);
  return held != held_.end() && held->key == key ? std::optional(*held) : std::nullopt;
}

template <class Key, class Value>
void SetpointHistory<Key, Value>::forget_before(Step step) {
  go_to(step);
  if (!messages_.empty()) {
    const Step last = std::min(step, messages_.front().stamp.from + 1);
    for (; !messages_.empty() && messages_.front().stamp.from <= last; messages_.pop_front()) {
      put(held_, messages_.front().stamp, messages_.front().said);
      said_ -= messages_.front().said.size();
    }
  }
  const auto is_over = [step](const Held& row) { return !row.value && row.stamp.from < step - 1; };
  erase_part(held_, next_held_, is_over);
  erase_part(newest_, next_row_, is_over);
}

template class SetpointHistory<BodyKey, Vec3>;
template class SetpointHistory<JointId, JointDrive>;

}  // namespace aurasim::core
