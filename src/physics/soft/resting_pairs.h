// Puts pairs away in which nobody is awake, and brings them back (physics/sleeping_pairs.h). Nothing that is computed
// depends on when.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/contact_cache.h"

struct btDispatcherInfo;

namespace aurasim::physics {

class ContactPairs;
class Dispatcher;
class FirstContacts;
class SoftIslands;

class RestingPairs {
 public:
  /// All have to outlive it.
  RestingPairs(ContactPairs& pairs, Dispatcher& dispatcher, const FirstContacts& first_contacts)
      : pairs_(pairs), dispatcher_(dispatcher), first_contacts_(first_contacts) {}

  /// Puts some pairs away, so that a step never takes long for it. Call after SoftIslands::call() and bring_back().
  void put_away(const SoftIslands& islands);
  /// Brings back all pairs of a body. Call before its contacts are looked at, if it no longer sleeps.
  void bring_back(std::uint32_t slot, const btDispatcherInfo& info);

 private:
  ContactPairs& pairs_;
  Dispatcher& dispatcher_;
  const FirstContacts& first_contacts_;
  int next_ = 0;  ///< index of the pair that put_away() looks at next
  int put_ = 0;   ///< pairs that were put away since memory was given back
  std::vector<PartManifold> made_;
  std::vector<double> rows_;
};

}  // namespace aurasim::physics
