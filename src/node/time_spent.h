// How much of a node's computing time goes into redos.
#pragma once

#include <algorithm>

#include "core/ids.h"

namespace aurasim::node {

/// Seconds, by NodeSetup::clock. Waiting is not included.
class TimeSpent {
 public:
  /// Adds a step after which the node is in state `now`, with its mail. `goes_back`: it was a redo, which puts the node
  /// back. States that had been computed before count as time of the redo, too.
  void add(core::Step now, double seconds, bool goes_back) {
    all_s_ += seconds;
    if (goes_back || now <= furthest_) in_redos_s_ += seconds;
    furthest_ = std::max(furthest_, now);
  }

  double all_s() const { return all_s_; }
  double in_redos_s() const { return in_redos_s_; }

 private:
  double all_s_ = 0;
  double in_redos_s_ = 0;
  core::Step furthest_ = 0;  ///< newest state that has been computed
};

}  // namespace aurasim::node
