// The stability experiment: every hard case at several steps and with every preset, on one node and on a border between
// two.
#pragma once

#include <string>
#include <vector>

#include "lab/measured_run.h"
#include "lab/on_threads.h"
#include "lab/summary.h"

namespace aurasim::lab {

struct StabilityPlan {
  std::vector<std::string> cases;  ///< none: every case
  std::vector<int> step_hz = {60, 120, 240, 1000};
  double standing_s = 60;  ///< how long piles have to stand with the preset `balanced`; 0: left out
};

/// One case under one set of rules, on one and on two nodes.
struct StabilityRow {
  Case what;
  RunRules rules;
  MeasuredRun one;
  MeasuredRun two;
  std::string preset;        ///< name of the preset, or empty
  bool is_standing = false;  ///< the long run in which piles have to stand

  bool same_bits() const { return one.hash == two.hash; }
  /// First state with different bits; -1 if there is none.
  core::Step first_difference() const;
};

StabilityRow run_stability(const Case& c, const RunRules& rules);

/// The rules of a preset, at 60 steps per second.
RunRules preset_rules(const std::string& preset);

std::vector<StabilityRow> run_stability(const StabilityPlan& plan, const Progress& progress);

/// The requirements, of those cases that were run.
std::vector<Target> stability_targets(const std::vector<StabilityRow>& rows);

}  // namespace aurasim::lab
