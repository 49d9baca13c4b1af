// Pairs of near objects of which both sleep, or one sleeps and the other one is static. They are in no list of a step,
// and their contacts are packed (packed_contacts.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "physics/contact_view.h"
#include "physics/packed_contacts.h"
#include "physics/pair_lists.h"

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

  bool empty() const { return pairs_.size() == 0; }
  std::size_t size() const { return pairs_.size(); }
  bool has(std::uint32_t slot) const { return pairs_.has(slot); }
  bool contains(const btBroadphaseProxy& a, const btBroadphaseProxy& b) const { return find(a, b) != kNone; }

  /// Puts in a pair of Bullet's, whose manifolds may be destroyed then. One of the two bodies is no static.
  void put(const btBroadphasePair& pair);
  /// Takes out a pair of the body. Precondition: has(slot).
  Pair take_one(std::uint32_t slot) { return pairs_.take(pairs_.first(slot) / 2); }
  /// Takes out all pairs: calls `visit(Pair)`.
  template <class Visit>
  void take_all(Visit&& visit) {
    pairs_.for_each([&](std::uint32_t at) { visit(std::move(pairs_.item(at))); });
    pairs_.clear();
  }
  /// Removes a pair, if it is there.
  void remove(const btBroadphaseProxy& a, const btBroadphaseProxy& b);
  /// Removes all pairs of an object.
  void remove_all_of(const btBroadphaseProxy& object);

  /// Calls `visit(ContactView)` for the contacts of two objects.
  template <class Visit>
  void for_each_contact(const btBroadphaseProxy& a, const btBroadphaseProxy& b, Visit&& visit) const {
    if (const std::uint32_t at = find(a, b); at != kNone) for_each_contact_of(pairs_.item(at), visit);
  }
  /// The same for all contacts of a body.
  template <class Visit>
  void for_each_contact(std::uint32_t slot, Visit&& visit) const {
    for (std::uint32_t link = pairs_.first(slot); link != kNone; link = pairs_.next(link)) {
      for_each_contact_of(pairs_.item(link / 2), visit);
    }
  }
  /// The same for all contacts.
  template <class Visit>
  void for_each_contact(Visit&& visit) const {
    pairs_.for_each([&](std::uint32_t at) { for_each_contact_of(pairs_.item(at), visit); });
  }
  /// The contacts of a pair that was taken out.
  template <class Visit>
  static void for_each_contact_of(const Pair& pair, Visit&& visit) {
    if (pair.contacts == nullptr) return;
    ContactReader reader(pair);
    while (reader.has_next()) visit(reader.next());
  }
  /// Calls `visit(other slot)` for the pairs of a body that touch.
  template <class Visit>
  void for_each_touch(std::uint32_t slot, Visit&& visit) const {
    for (std::uint32_t link = pairs_.first(slot); link != kNone; link = pairs_.next(link)) {
      if (pairs_.item(link / 2).contacts != nullptr) visit(pairs_.other(link));
    }
  }

 private:
  static constexpr std::uint32_t kNone = PairLists<Pair>::kNone;

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

  std::uint32_t find(const btBroadphaseProxy& a, const btBroadphaseProxy& b) const;

  PairLists<Pair> pairs_;
  PackedBytes bytes_;  ///< space for put()
};

}  // namespace aurasim::physics
