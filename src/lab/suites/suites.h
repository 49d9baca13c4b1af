// The suites of `aurasim-lab run`: each measures what a page of docs/ shows.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lab/on_threads.h"
#include "lab/suites/result_row.h"
#include "lab/summary.h"

namespace aurasim::lab {

/// A quick run measures some of the cases of a full run, each in the same way, so that their values can be compared.
enum class Effort : std::uint8_t { kQuick, kFull };

struct SuiteResults {
  std::vector<ResultRow> rows;
  std::vector<Target> targets;  ///< requirements; a run in which one is not met fails
};

/// The parts of a suite that are to be run.
struct SuitePlan {
  Effort effort = Effort::kQuick;
  std::vector<std::string> only;  ///< names of parts; none: those that belong to the effort

  bool is_full() const { return effort == Effort::kFull; }
  /// True if the part is named, or no part is named.
  bool wants(const std::string& part) const;
};

/// If `progress` ends a suite early, its results are not to be stored.
struct Suite {
  const char* name;
  const char* about;
  SuiteResults (*run)(const SuitePlan& plan, const Progress& progress);
  std::vector<std::string> (*parts)();  ///< parts that can be run alone
};

std::span<const Suite> suites();

SuiteResults run_accuracy_suite(const SuitePlan& plan, const Progress& progress);
std::vector<std::string> accuracy_parts();
SuiteResults run_blocks_suite(const SuitePlan& plan, const Progress& progress);
std::vector<std::string> blocks_parts();
SuiteResults run_correctness_suite(const SuitePlan& plan, const Progress& progress);
std::vector<std::string> correctness_parts();
/// Real nodes over DDS on loopback, in real time: 15 minutes, nearly all of it waiting.
SuiteResults run_correctness_over_dds_suite(const SuitePlan& plan, const Progress& progress);
std::vector<std::string> correctness_over_dds_parts();
SuiteResults run_solvers_suite(const SuitePlan& plan, const Progress& progress);
std::vector<std::string> solvers_parts();

/// Adds each target as a case "requirement/NAME" with what was found and what is allowed.
void add_targets(SuiteResults& results, const std::vector<Target>& targets);

}  // namespace aurasim::lab
