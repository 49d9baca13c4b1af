// Pairs of bodies, in a list of each of its two bodies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

namespace aurasim::physics {

/// Bodies are named by their slots (soft/islands.h). A static has slot 0, and no list. Several threads may read at the
/// same time. `Item`: what is kept of a pair.
template <class Item>
class PairLists {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  std::size_t size() const { return count_; }
  bool has(std::uint32_t slot) const { return first(slot) != kNone; }
  /// Link of the first pair of a body; kNone: it has none. A link is the index of a pair times 2, and which of its two
  /// bodies it belongs to.
  std::uint32_t first(std::uint32_t slot) const { return slot < first_.size() ? first_[slot] : kNone; }
  std::uint32_t next(std::uint32_t link) const { return pairs_[link / 2].next[link % 2]; }
  std::uint32_t other(std::uint32_t link) const { return pairs_[link / 2].slots[1 - link % 2]; }

  Item& item(std::uint32_t at) { return pairs_[at].item; }
  const Item& item(std::uint32_t at) const { return pairs_[at].item; }
  std::uint32_t slot(std::uint32_t at, int side) const { return pairs_[at].slots[side]; }

  /// Returns the index of the new pair. One of the two slots is not 0.
  std::uint32_t add(std::uint32_t a, std::uint32_t b, Item item) {
    std::uint32_t at = static_cast<std::uint32_t>(pairs_.size());
    if (free_.empty()) {
      pairs_.emplace_back();
    } else {
      at = free_.back();
      free_.pop_back();
    }
    Entry& entry = pairs_[at];
    entry.item = std::move(item);
    entry.slots[0] = a, entry.slots[1] = b;
    link(at, 0), link(at, 1);
    ++count_;
    return at;
  }

  /// Takes out the pair of an index.
  Item take(std::uint32_t at) {
    unlink(at, 0), unlink(at, 1);
    Item taken = std::exchange(pairs_[at].item, {});
    pairs_[at].slots[0] = pairs_[at].slots[1] = 0;
    free_.push_back(at);
    if (--count_ == 0) pairs_.clear(), free_ = {};
    return taken;
  }

  void clear() {
    pairs_.clear();
    free_.clear();
    first_.clear();
    count_ = 0;
  }

  /// Calls `visit(index)` for all pairs.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::uint32_t at = 0; at < pairs_.size(); ++at) {
      if (pairs_[at].slots[0] != pairs_[at].slots[1]) visit(at);
    }
  }

 private:
  struct Entry {
    [[no_unique_address]] Item item{};
    std::uint32_t slots[2] = {};                                         ///< both 0: not used
    std::uint32_t next[2] = {kNone, kNone}, before[2] = {kNone, kNone};  ///< links of the pairs of each body
  };

  void link(std::uint32_t at, int side) {
    Entry& entry = pairs_[at];
    const std::uint32_t slot = entry.slots[side];
    if (slot == 0) return;
    if (slot >= first_.size()) first_.resize(slot + 1, kNone);
    const std::uint32_t next = first_[slot];
    first_[slot] = 2 * at + static_cast<std::uint32_t>(side);
    entry.next[side] = next, entry.before[side] = kNone;
    if (next != kNone) pairs_[next / 2].before[next % 2] = first_[slot];
  }

  void unlink(std::uint32_t at, int side) {
    const Entry& entry = pairs_[at];
    if (entry.slots[side] == 0) return;
    const std::uint32_t next = entry.next[side], before = entry.before[side];
    (before == kNone ? first_[entry.slots[side]] : pairs_[before / 2].next[before % 2]) = next;
    if (next != kNone) pairs_[next / 2].before[next % 2] = before;
  }

  std::deque<Entry> pairs_;
  std::vector<std::uint32_t> free_;   ///< indices in pairs_
  std::vector<std::uint32_t> first_;  ///< by slot
  std::size_t count_ = 0;
};

}  // namespace aurasim::physics
