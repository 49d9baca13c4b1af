// Sums over trials, and the requirements for them.
#pragma once

#include <string>
#include <vector>

#include "lab/metrics.h"

namespace aurasim::lab {

/// One requirement: a value that was found, and its limit.
struct Target {
  std::string name;
  double found = 0;
  double allowed = 0;
  bool at_least = false;  ///< `allowed` is a lower bound

  bool met() const { return at_least ? found >= allowed : found <= allowed; }
};

/// Trials by kind of pairs, series, aura and sync mode, within and beyond the tolerance.
class Tallies {
 public:
  void add(const Trial& trial);

  struct Key {
    PairKind pairs{};
    std::string series;
    Variant variant;
    bool within = false;
    double value = -1;  ///< only where single values matter (loss); -1: all
  };
  /// Sum of the tallies whose key `wanted(key)` selects.
  template <class Wanted>
  Tally sum(Wanted&& wanted) const {
    Tally total;
    for (const Entry& entry : entries_) {
      if (wanted(entry.key)) total.add(entry.tally);
    }
    return total;
  }

  struct Entry {
    Key key;
    Tally tally;
  };
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Entry> entries_;
};

/// Requirements from docs/design.md, "What is counted", and from the thesis's numbers. Only those for which the
/// campaign has trials.
std::vector<Target> collision_targets(const Tallies& tallies);
std::vector<Target> loss_targets(const Tallies& tallies);

}  // namespace aurasim::lab
