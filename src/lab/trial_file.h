// collisions.csv: one row per trial and variant, in the order of the jobs that made them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "lab/metrics.h"

namespace aurasim::lab {

std::string trial_header();
/// One line with its end.
std::string trial_row(const Trial& trial);

/// Calls `row` for each complete line.
void read_trials(const std::filesystem::path& file, const std::function<void(const Trial&)>& row);

/// Keeps the header and the first `rows / block * block` complete rows; returns how many blocks of `block` rows these
/// are. A file that does not exist, or has another header, is begun anew.
std::size_t keep_whole_blocks(const std::filesystem::path& file, std::size_t block);

}  // namespace aurasim::lab
