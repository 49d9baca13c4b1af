// One measured number, as it is stored in docs/results/SUITE.jsonl.
#pragma once

#include <string>

namespace aurasim::lab {

/// A value of one case. The case and the metric together name the row: a newer row with the same names replaces it.
struct ResultRow {
  std::string what;    ///< the case; its parts are divided by '/', for example "stack_20/exact"
  std::string metric;  ///< what was measured, without the unit
  double value = 0;
  std::string unit;  ///< "1" for a number without unit, "ratio" for one time over another
  int n = 1;         ///< how many measurements the value is the median or sum of
};

/// Largest relative difference from a stored value that is not worth a word. Times and their ratios scatter. Everything
/// else is computed from the same bits, and pages show three digits of it.
double tolerance_of(const ResultRow& row);

}  // namespace aurasim::lab
