// One process per region on this host, watched until the last one ends.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "cli/commands.h"
#include "cli/live_table.h"
#include "cli/node_ending.h"
#include "cli/node_process.h"
#include "cli/run_steering.h"
#include "cli/viewer_process.h"

namespace aurasim::cli {

struct LaunchOptions {
  FileArguments files;
  std::optional<core::Step> steps;
  std::optional<std::filesystem::path> report;
  bool headless = false;
  std::string recording;  ///< file; empty: none
  int start_time_out_s = 30;
};

class Launcher {
 public:
  Launcher(const config::Launch& launch, const LaunchOptions& options);
  /// Ends what is still running.
  ~Launcher();

  ExitCode run();

 private:
  struct Child {
    core::RegionId region{};
    pid_t pid = 0;
    bool running = true;
    int exit_code = 0;  ///< 128 + signal when it was killed
    bool died = false;  ///< ended before the run did
  };

  void start_nodes();
  pid_t start_node(std::uint32_t region) const;
  std::vector<std::string> arguments_of(std::uint32_t region) const;
  void collect_exits();
  bool any_running() const;
  void stop_all();
  void urge(const Child& child, NodeEnding& ending);
  std::vector<std::uint32_t> running_regions() const;
  void signal_all(int signal) const;
  void show();
  ExitCode conclude();
  ExitCode report_and_count(ExitCode so_far);

  const config::Launch& launch_;
  LaunchOptions options_;
  dds::Participant participant_;
  dds::ControlBus control_;
  TerminalView view_;
  std::vector<Child> children_;
  ViewerProcess viewer_;
};

}  // namespace aurasim::cli
