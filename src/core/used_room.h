// Memory that a busy time has left behind.
#pragma once

#include <algorithm>
#include <cstddef>

namespace aurasim::core {

/// Lists of a step keep their memory, so that a warm step allocates nothing. UsedRoom notices when they keep much more
/// than steps have used for a while, as after a world has fallen asleep. It decides by the numbers of items alone, so
/// all runs of a world decide the same.
class UsedRoom {
 public:
  /// Call once a step with the number of items of its lists. Returns true if the lists should free their memory now:
  /// no step of late has used a quarter of what the lists have room for.
  bool is_spare(std::size_t used) {
    most_ = std::max(most_, used);
    if (++steps_ < kSteps) return false;
    const bool spare = room_ > kFew + 4 * most_;
    room_ = spare ? most_ : std::max(room_, most_);
    steps_ = 0;
    most_ = 0;
    return spare;
  }

  /// Memory counts as spare only after so many steps.
  static constexpr int kSteps = 128;
  /// Room for so many items is never spare.
  static constexpr std::size_t kFew = 256;

 private:
  int steps_ = 0;
  std::size_t most_ = 0;  ///< items of a step since steps_ was 0
  std::size_t room_ = 0;  ///< items of a step before that
};

/// Empties the lists and frees their memory.
template <class... Lists>
void free_memory(Lists&... lists) {
  ((lists = Lists()), ...);
}

}  // namespace aurasim::core
