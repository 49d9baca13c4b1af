// The rain on real nodes: one process per region over DDS on this host, by the wall clock.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/scale/rain.h"
#include "lab/scale/window.h"

namespace aurasim::lab::commands {

/// Runs `aurasim launch` on the launch file with the rain's overrides, and reads its report. Nothing when
/// the run fails. In the resulting windows, times are of the wall clock, and counts of bytes and datagrams are 0.
std::optional<std::vector<lab::Window>> run_processes(const lab::Rain& rain, const std::filesystem::path& launch_file,
                                                      const std::filesystem::path& report);

/// The windows made from the steps of a report.
std::vector<lab::Window> windows_of_report(const std::filesystem::path& report, std::size_t regions, double step_s);

}  // namespace aurasim::lab::commands
