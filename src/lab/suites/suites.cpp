#include "lab/suites/suites.h"

#include <algorithm>
#include <array>

namespace aurasim::lab {

std::span<const Suite> suites() {
  static constexpr std::array kSuites = {
      Suite{"accuracy", "hard cases against closed forms, and error against CPU time (docs/accuracy.md)",
            run_accuracy_suite, accuracy_parts},
      Suite{"blocks", "hard cases with blocks of 8, 16 and 32 m (docs/accuracy.md)", run_blocks_suite, blocks_parts},
      Suite{"correctness", "do bodies collide across borders as in one world? (docs/correctness.md)",
            run_correctness_suite, correctness_parts},
      Suite{"correctness_over_dds", "a part of it in real time, over DDS on loopback (docs/correctness.md)",
            run_correctness_over_dds_suite, correctness_over_dds_parts},
      Suite{"solvers", "can the soft step replace sequential_impulse? (docs/accuracy.md)", run_solvers_suite,
            solvers_parts},
  };
  return kSuites;
}

bool SuitePlan::wants(const std::string& part) const {
  return only.empty() || std::ranges::find(only, part) != only.end();
}

void add_targets(SuiteResults& results, const std::vector<Target>& targets) {
  for (const Target& target : targets) {
    const std::string what = "requirement/" + target.name;
    results.rows.push_back({what, "found", target.found, "1"});
    results.rows.push_back({what, target.at_least ? "at least" : "at most", target.allowed, "1"});
    results.targets.push_back(target);
  }
}

}  // namespace aurasim::lab
