// The runs of the speed experiment (runs.csv and states, of our step and of other engines) as rows of results.
#pragma once

#include <filesystem>
#include <vector>

#include "lab/suites/result_row.h"

namespace aurasim::lab {

/// Times are medians of the runs. Throws std::runtime_error if a file is missing or a line of it is malformed.
std::vector<ResultRow> speed_rows(const std::filesystem::path& directory);

}  // namespace aurasim::lab
