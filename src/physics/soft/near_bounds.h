// The bounds of awake bodies by slot, rounded, in 32 octets each. Most pairs of near bodies are apart, and these bounds
// show it without a look at the broadphase's objects, which are scattered in memory. Rounding keeps the order of two
// numbers, so bounds that overlap do so rounded, too.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/bounds.h"

namespace aurasim::physics {

class NearBounds {
 public:
  /// Forgets all bounds, and makes room for slots below `slots`.
  void begin(std::size_t slots) {
    ++now_;
    if (now_ == 0) entries_.clear(), now_ = 1;
    if (entries_.size() < slots) entries_.resize(slots);
  }
  /// Several threads may call it for different slots.
  void note(std::uint32_t slot, const Bounds& bounds) {
    Entry& entry = entries_[slot];
    for (int k = 0; k < 3; ++k) {
      entry.low[k] = static_cast<float>(bounds.low[k]), entry.high[k] = static_cast<float>(bounds.high[k]);
    }
    entry.step = now_;
  }
  /// True only if the bounds of both are known and do not overlap.
  bool are_apart(std::uint32_t a, std::uint32_t b) const {
    const Entry &one = entries_[a], &other = entries_[b];
    if (one.step != now_ || other.step != now_) return false;
    bool apart = false;
    for (int k = 0; k < 3; ++k) apart |= one.low[k] > other.high[k] || other.low[k] > one.high[k];
    return apart;
  }
  void prefetch(std::uint32_t slot) const { __builtin_prefetch(&entries_[slot]); }

 private:
  struct alignas(32) Entry {
    float low[3] = {}, high[3] = {};
    std::uint32_t step = 0;
  };

  std::vector<Entry> entries_;
  std::uint32_t now_ = 0;
};

}  // namespace aurasim::physics
