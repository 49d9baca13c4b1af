// What has been said of many bodies, or of many joints, and for which states. Messages stay whole and in order, and the
// newest state that was asked for is laid out: when all are told something in every state, each look goes through
// memory from front to back, of a thousand as of one.
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

/// Of two messages about the same, the later one counts.
struct MessageStamp {
  Step from = 0;  ///< the first state that shows the effect
  std::uint64_t client = 0;
  std::uint64_t sequence = 0;
  auto operator<=>(const MessageStamp&) const = default;
};

/// Of a list in the order of its states the first that is later than `step`. Mostly it is asked for the newest ones, so
/// it is looked for from the end: a search through all of them would touch memory that nobody else does.
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
    std::optional<Value> value;  ///< nothing: lets go of it
  };
  /// What was said last of one, by some state.
  struct Held {
    Key key{};
    MessageStamp stamp;
    std::optional<Value> value;
  };

  /// `said`: in any order; of two with one key the last one counts.
  void add(const MessageStamp& stamp, std::vector<Said> said);

  bool empty() const { return messages_.empty() && held_.empty(); }
  /// All that is remembered.
  std::size_t size() const { return said_ + held_.size(); }
  /// Of how many something has been said.
  std::size_t keys() const { return newest_.size(); }

  /// visit(Held) by state `step`, ascending key, of those that is_wanted(key).
  template <class IsWanted, class Visit>
  void for_each(Step step, IsWanted&& is_wanted, Visit&& visit) const {
    go_to(step);
    visit_rows(newest_.begin(), newest_.end(), step, is_wanted, visit);
  }
  /// visit(Held) by state `step`, ascending key, from `first` on as long as is_one(key).
  template <class IsOne, class Visit>
  void for_each_from(const Key& first, Step step, IsOne&& is_one, Visit&& visit) const {
    go_to(step);
    const auto begin = std::ranges::lower_bound(newest_, first, {}, &Held::key);
    const auto end = std::find_if_not(begin, newest_.end(), [&](const Held& row) { return is_one(row.key); });
    const auto all = [](const Key&) { return true; };
    visit_rows(begin, end, step, all, visit);
  }
  /// visit(stamp, Said) for what states later than `step` show first, in order.
  template <class Visit>
  void for_each_later(Step step, Step last, Visit&& visit) const {
    for (auto message = later_than(step); message != messages_.end() && message->stamp.from <= last; ++message) {
      for (const Said& said : message->said) visit(message->stamp, said);
    }
  }

  /// States before this one are not asked for any more. To be called once a state: it forgets messages of two states,
  /// and looks at some of those of whom nothing is in effect.
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
  /// What was said of it last before the message `later`; nothing: nothing was.
  std::optional<Held> before(const Key& key, typename Messages::const_iterator later) const;
  template <class IsWanted, class Visit>
  void visit_rows(typename Rows::const_iterator begin, typename Rows::const_iterator end, Step step,
                  const IsWanted& is_wanted, const Visit& visit) const {
    std::optional<typename Messages::const_iterator> later;  // a state that was computed before is asked for
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
  Rows held_;          ///< ascending key: before the first message that is remembered
  /// Ascending key: by the newest state that was asked for. It runs along, so that asking changes no answer; but one
  /// thread at a time.
  mutable Rows newest_;
  mutable Step asked_ = std::numeric_limits<Step>::min();
  std::size_t said_ = 0;       ///< entries of messages_
  std::size_t next_row_ = 0;   ///< of newest_, to be looked at next for what is over
  std::size_t next_held_ = 0;  ///< likewise
};

}  // namespace aurasim::core
