// The suites of `aurasim-lab run`: each measures what a page of docs/ shows.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "lab/suites/result_row.h"
#include "lab/summary.h"

namespace aurasim::lab {

/// A quick run measures some of the cases of a full run, each in the same way, so that their values can be compared.
enum class Effort : std::uint8_t { kQuick, kFull };

struct SuiteResults {
  std::vector<ResultRow> rows;
  std::vector<Target> targets;  ///< requirements; a run in which one is not met fails
};

/// Called with the share done; false from it ends the suite early, and its results are not to be stored.
using SuiteProgress = std::function<bool(double share)>;

struct Suite {
  const char* name;
  const char* about;
  SuiteResults (*run)(Effort effort, const SuiteProgress& progress);
};

std::span<const Suite> suites();

SuiteResults run_accuracy_suite(Effort effort, const SuiteProgress& progress);
SuiteResults run_correctness_suite(Effort effort, const SuiteProgress& progress);
/// Real nodes over DDS on loopback, in real time: 15 minutes, nearly all of it waiting.
SuiteResults run_correctness_over_dds_suite(Effort effort, const SuiteProgress& progress);
SuiteResults run_solvers_suite(Effort effort, const SuiteProgress& progress);

/// Adds each target as a case "requirement/NAME" with what was found and what is allowed.
void add_targets(SuiteResults& results, const std::vector<Target>& targets);

}  // namespace aurasim::lab
