// Pairs of near objects of which both sleep, or one sleeps and the other one is static. They are in no list of a step,
// and their contacts are packed (packed_contacts.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "physics/contact_view.h"
#include "physics/packed_contacts.h"

struct btBroadphasePair;
struct btBroadphaseProxy;

namespace aurasim::physics {

/// Bodies are named by their slots (soft/islands.h); a static has slot 0. Several threads may ask at the same time.
class SleepingPairs {
 public:
  /// A pair as it is taken out.
  struct Pair {
    btBroadphaseProxy *proxy0 = nullptr, *proxy1 = nullptr;
    std::unique_ptr<std::uint8_t[]> contacts;  ///< null: they do not touch
  };

  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  bool has(std::uint32_t slot) const { return slot < first_.size() && first_[slot] != kNone; }
  bool contains(const btBroadphaseProxy& a, const btBroadphaseProxy& b) const { return find(a, b) != kNone; }

  /// Puts in a pair of Bullet's, whose manifolds may be destroyed then. One of the two bodies is no static.
  void put(const btBroadphasePair& pair);
  /// Takes out a pair of the body. Precondition: has(slot).
  Pair take_one(std::uint32_t slot) { return take(first_[slot] / 2); }
  /// Takes out all pairs: calls `visit(Pair)`.
  template <class Visit>
  void take_all(Visit&& visit) {
    for (Entry& entry : pairs_) {
      if (entry.pair.proxy0 != nullptr) visit(std::move(entry.pair));
    }
    pairs_.clear();
    free_.clear();
    first_.clear();
    count_ = 0;
  }
  /// Removes a pair, if it is there.
  void remove(const btBroadphaseProxy& a, const btBroadphaseProxy& b);
  /// Removes all pairs of an object.
  void remove_all_of(const btBroadphaseProxy& object);

  /// Calls `visit(ContactView)` for the contacts of two objects.
  template <class Visit>
  void for_each_contact(const btBroadphaseProxy& a, const btBroadphaseProxy& b, Visit&& visit) const {
    if (const std::uint32_t at = find(a, b); at != kNone) for_each_contact(pairs_[at], visit);
  }
  /// The same for all.
  template <class Visit>
  void for_each_contact(Visit&& visit) const {
    for (const Entry& entry : pairs_) {
      if (entry.pair.contacts != nullptr) for_each_contact(entry.pair, visit);
    }
  }
  /// The contacts of a pair that was taken out.
  template <class Visit>
  static void for_each_contact(const Pair& pair, Visit&& visit) {
    ContactReader reader(pair);
    while (reader.has_next()) visit(reader.next());
  }
  /// Calls `visit(slot, slot)` for the pairs that touch.
  template <class Visit>
  void for_each_touch(Visit&& visit) const {
    for (const Entry& entry : pairs_) {
      if (entry.pair.contacts != nullptr) visit(entry.slots[0], entry.slots[1]);
    }
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// Reads the contacts of a pair one after another.
  class ContactReader {
   public:
    explicit ContactReader(const Pair& pair);
    bool has_next() const { return left_ > 0; }
    ContactView next();

   private:
    const Pair& pair_;
    const std::uint8_t* at_;
    std::size_t left_;
  };

  /// A link is the index of an entry times 2, and which of its two bodies it belongs to.
  struct Entry {
    Pair pair;
    std::uint32_t slots[2] = {};
    std::uint32_t next[2] = {kNone, kNone}, before[2] = {kNone, kNone};  ///< links of the pairs of each body
  };

  template <class Visit>
  static void for_each_contact(const Entry& entry, Visit&& visit) {
    if (entry.pair.contacts != nullptr) for_each_contact(entry.pair, visit);
  }
  std::uint32_t find(const btBroadphaseProxy& a, const btBroadphaseProxy& b) const;
  Pair take(std::uint32_t at);
  void link(std::uint32_t at, int side);
  void unlink(std::uint32_t at, int side);

  std::deque<Entry> pairs_;           ///< those with no proxies are free
  std::vector<std::uint32_t> free_;   ///< indices in pairs_
  std::vector<std::uint32_t> first_;  ///< by slot: link of the first pair; kNone: no pair
  std::size_t count_ = 0;
  PackedBytes bytes_;  ///< space for put()
};

}  // namespace aurasim::physics
