#include "setup/launch_options.h"

#include <fmt/format.h>

#include "host/other_role.h"
#include "setup/launch_setup.h"

namespace aurasim::setup {
namespace {

/// Command-line options that nodes and spares share.
std::vector<std::string> command_line(const char* command, const config::Launch& launch, const LaunchOptions& options,
                                      std::uint64_t run) {
  std::vector<std::string> words = {host::own_program(), command,         options.files.file, "--run",
                                    std::to_string(run), "--has-launcher"};
  words.insert(words.end(), options.heartbeat.begin(), options.heartbeat.end());
  for (const std::string& change : options.files.overrides) words.insert(words.end(), {"--set", change});
  words.insert(words.end(), {"--set", "physics.threads=" + std::to_string(threads_of(launch, launch.regions.size()))});
  if (!options.load.file.empty()) words.insert(words.end(), {"--load", options.load.file});
  if (options.load.other_build) words.emplace_back("--other-build");
  if (options.save.folder_is_given) words.insert(words.end(), {"--saves", options.save.folder});
  words.insert(words.end(), {"--save-every", fmt::format("{}", options.save.every_s), "--save-keep",
                             std::to_string(options.save.keep)});
  if (options.steps) words.insert(words.end(), {"--steps", std::to_string(*options.steps)});
  if (options.report) words.insert(words.end(), {"--report", options.report->string()});
  return words;
}

}  // namespace

std::vector<std::string> node_command_line(const config::Launch& launch, const LaunchOptions& options,
                                           std::uint64_t run, core::RegionId region, Start start) {
  std::vector<std::string> words = command_line("node", launch, options, run);
  words.insert(words.end(), {"--region", std::to_string(core::value_of(region)), "--start-time-out",
                             std::to_string(options.start_time_out_s)});
  if (start == Start::kTakeOver) words.emplace_back("--take-over");
  return words;
}

std::vector<std::string> spare_command_line(const config::Launch& launch, const LaunchOptions& options,
                                            std::uint64_t run) {
  return command_line("spare", launch, options, run);
}

std::vector<std::string> hub_command_line(const LaunchOptions& options) {
  std::vector<std::string> words = {host::own_program(), "hub", options.files.file};
  for (const std::string& change : options.files.overrides) words.insert(words.end(), {"--set", change});
  return words;
}

}  // namespace aurasim::setup
