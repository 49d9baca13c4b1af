// Options of a launch, and the command lines of its processes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "cut/saved_world.h"
#include "setup/arguments.h"

namespace aurasim::setup {

struct LaunchOptions {
  command_line::FileArguments files;
  KeyArguments keys;
  std::optional<core::Step> steps;
  std::optional<std::filesystem::path> report;
  bool headless = false;
  std::string recording;  ///< file; empty: none
  cut::LoadArguments load;
  cut::SaveArguments save;
  bool resume = false;  ///< goes on from the newest saved world
  int start_time_out_s = 30;
  std::vector<std::string> heartbeat;  ///< words for processes that a launcher watches (heartbeat.h)
  int spares = 0;                      ///< number of spare processes; with 0, a process is started when it is needed
};

enum class Start : std::uint8_t { kWithOthers, kTakeOver };

/// Program and arguments of the node of `region` in run `run`.
std::vector<std::string> node_command_line(const config::Launch& launch, const LaunchOptions& options,
                                           std::uint64_t run, core::RegionId region, Start start);
/// Program and arguments of a spare of run `run`, which waits until a region needs it.
std::vector<std::string> spare_command_line(const config::Launch& launch, const LaunchOptions& options,
                                            std::uint64_t run);

/// Program and arguments of the run's hub (dds.discovery: neighbours).
std::vector<std::string> hub_command_line(const LaunchOptions& options);

}  // namespace aurasim::setup
