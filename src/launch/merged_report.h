// Merges the records of a run's nodes into one report, and prints a short account of it.
#pragma once

#include <filesystem>
#include <string>

#include "command_line/exit_code.h"
#include "records/report.h"

namespace aurasim::launch {

/// The last line of a run's output. If records are missing, it says what is not known.
std::string closing_line(const records::Accounts& accounts);

/// Merges `folder` (see node::merge_report). Returns `so_far`, or kFailed when a body is lost or hosted twice, or when
/// records are missing.
command_line::ExitCode merge_and_print(const std::filesystem::path& folder, const records::RunFacts& facts,
                                       command_line::ExitCode so_far);

}  // namespace aurasim::launch
