// The stored results of a suite: one JSON object per line, appended by each run (docs/results.md, "Stored results").
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lab/suites/result_row.h"

namespace aurasim::lab {

/// Where and with what a suite was run.
struct Provenance {
  std::string commit;   ///< with "-dirty" when sources were changed after it
  std::string date;     ///< YYYY-MM-DD, UTC
  std::string machine;  ///< cores and processor
  bool quick = false;   ///< a quick run: pages ignore its rows
};

/// Today, this machine.
Provenance provenance_here(std::string commit, bool quick);

/// Appends one line per row. Throws std::runtime_error if the file cannot be written.
void append_results(const std::filesystem::path& file, const std::vector<ResultRow>& rows, const Provenance& from);

/// A stored value of a full run that a new row does not repeat within its tolerance.
struct Difference {
  ResultRow now;
  double stored = 0;
  std::string stored_commit;
};

/// Compares rows with the newest rows of full runs in the file. Rows that the file does not have are skipped. Throws
/// std::runtime_error with file and line for a line that is not a row.
std::vector<Difference> differences(const std::filesystem::path& file, const std::vector<ResultRow>& rows);

}  // namespace aurasim::lab
