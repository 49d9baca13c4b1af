// The setpoints of many bodies, or of many joints, by state. Messages stay whole and in order. The values of the newest
// state that was asked for are kept in one sorted array. So a look at a state reads memory from front to back, also
// where every body gets a setpoint in every state.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "core/ids.h"

namespace aurasim::core {

/// Sort key of messages. Of two messages about the same key, the one with the higher stamp counts.
struct MessageStamp {
  Step from = 0;  ///< the first state that shows the effect
  std::uint64_t client = 0;
  std::uint64_t sequence = 0;
  auto operator<=>(const MessageStamp&) const = default;
};

/// The first entry of `list`, ascending by state, that is later than `step`. Looks from the end first, because most
/// calls ask for the newest states: a binary search through the whole list would touch memory that is not in the cache.
template <class List, class StepOf>
auto first_later(const List& list, Step step, StepOf step_of) {
  constexpr int kNewest = 16;
  auto later = list.end();
  for (int i = 0; i < kNewest; ++i) {
    if (later == list.begin() || std::invoke(step_of, *(later - 1)) <= step) return later;
    --later;
  }
  return std::ranges::upper_bound(list.begin(), later, step, {}, step_of);
}

template <class Key, class Value>
class SetpointHistory {
 public:
  struct Said {
    Key key{};
    std::optional<Value> value;  ///< nothing: the setpoint ends
  };
  /// The last setpoint of a key up to some state.
  struct Held {
    Key key{};
    MessageStamp stamp;
    std::optional<Value> value;
  };

  /// Adds a message. `said` may be in any order; of two entries with one key the last one counts.
  void add(const MessageStamp& stamp, std::vector<Said> said);

  bool empty() const { return messages_.empty() && held_.empty(); }
  /// Number of entries remembered.
  std::size_t size() const { return said_ + held_.size(); }
  /// Number of keys that have a setpoint in the newest state asked for.
  std::size_t keys() const { return newest_.size(); }

  /// Calls visit(Held) for the last setpoint up to state `step` of each key with is_wanted(key), ascending key.
  template <class IsWanted, class Visit>
  void for_each(Step step, IsWanted&& is_wanted, Visit&& visit) const {
    go_to(step);
    visit_rows(newest_.begin(), newest_.end(), step, is_wanted, visit);
  }
  /// Like for_each(), for the keys from `first` on as long as is_one(key).
  template <class IsOne, class Visit>
  void for_each_from(const Key& first, Step step, IsOne&& is_one, Visit&& visit) const {
    go_to(step);
    const auto begin = std::ranges::lower_bound(newest_, first, {}, &Held::key);
    const auto end = std::find_if_not(begin, newest_.end(), [&](const Held& row) { return is_one(row.key); });
    const auto all = [](const Key&) { return true; };
    visit_rows(begin, end, step, all, visit);
  }
  /// Calls visit(stamp, Said) for each entry whose effect begins after `step` and not after `last`, in order.
  template <class Visit>
  void for_each_later(Step step, Step last, Visit&& visit) const {
    for (auto message = later_than(step); message != messages_.end() && message->stamp.from <= last; ++message) {
      for (const Said& said : message->said) visit(message->stamp, said);
    }
  }

  /// States before `step` are not asked for any more. Call once a state: each call forgets the messages of up to two
  /// states, and some of the rows whose setpoint has ended.
  void forget_before(Step step);

 private:
  struct Message {
    MessageStamp stamp;
    std::vector<Said> said;  ///< ascending key
  };
  using Messages = std::deque<Message>;
  using Rows = std::vector<Held>;

  typename Messages::const_iterator later_than(Step step) const {
    return first_later(messages_, step, [](const Message& message) { return message.stamp.from; });
  }
  void go_to(Step step) const;
  static void put(Rows& rows, const MessageStamp& stamp, const std::vector<Said>& said);
  /// The last setpoint of `key` before the message `later`; nothing if there is none.
  std::optional<Held> before(const Key& key, typename Messages::const_iterator later) const;
  template <class IsWanted, class Visit>
  void visit_rows(typename Rows::const_iterator begin, typename Rows::const_iterator end, Step step,
                  const IsWanted& is_wanted, const Visit& visit) const {
    std::optional<typename Messages::const_iterator> later;  // needed only if an earlier state is asked for again
    for (auto row = begin; row != end; ++row) {
      if (!is_wanted(row->key)) continue;
      if (row->stamp.from <= step) {
        visit(*row);
      } else {
        if (!later) later = later_than(step);
        if (const auto held = before(row->key, *later)) visit(*held);
      }
    }
  }

  Messages messages_;  ///< ascending stamp
  Rows held_;          ///< the last setpoints before the first message remembered, ascending key
  /// The last setpoints up to state asked_, ascending key. A cache: queries move it forward and their answers do not
  /// depend on it. Hence only one thread at a time may ask.
  mutable Rows newest_;
  mutable Step asked_ = std::numeric_limits<Step>::min();
  std::size_t said_ = 0;       ///< number of entries in messages_
  std::size_t next_row_ = 0;   ///< row of newest_ to test next for a setpoint that is over
  std::size_t next_held_ = 0;  ///< row of held_ to test next
};

}  // namespace aurasim::core
