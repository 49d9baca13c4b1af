// Starts one process per region on this host, and watches them until the last one ends.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "command_line/exit_code.h"
#include "dds/random_id.h"
#include "host/folder_lock.h"
#include "host/heartbeat.h"
#include "launch/hub_process.h"
#include "launch/live_table.h"
#include "launch/start_watch.h"
#include "launch/viewer_process.h"
#include "process/long_step.h"
#include "process/node_ending.h"
#include "setup/launch_options.h"
#include "steering/run_steering.h"

namespace aurasim::launch {

class Launcher {
 public:
  Launcher(const config::Launch& launch, const setup::LaunchOptions& options);
  /// Ends the processes that are still running.
  ~Launcher();

  command_line::ExitCode run();
  /// Number of this run. All its nodes have it, and no other run does.
  std::uint64_t number() const { return run_; }

 private:
  struct Child {
    core::RegionId region{};
    pid_t pid = 0;
    bool running = true;
    int exit_code = 0;  ///< 128 + signal when it was killed
    bool told_to_end = false;
    bool died = false;    ///< ended before the run did
    pid_t successor = 0;  ///< process that takes the region over when this one leaves; 0: it does not leave
    pid_t hung = 0;       ///< process that was ended because it hung; 0: none
    /// Number of deaths in a row of the region's nodes near the same state.
    int deaths = 0;
    core::Step died_at = 0;
  };

  void take_report_folder();
  void start_nodes();
  pid_t start_node(core::RegionId region, setup::Start start) const;
  void hear_commands();
  bool begin_drain(const messages::RunCommand& drain);
  void end_hung_nodes();
  void tell_long_steps();
  void collect_exits();
  void tell_lost(const Child& child);
  bool has_finished(const Child& child);
  void end_successor(Child& child);
  const messages::SeenStatus* said_by(const Child& child);
  void note_exit(Child& child, int status);
  bool can_be_replaced(const Child& child) const;
  bool somebody_knows_the_world();
  void replace(Child& child);
  void break_off(const std::string& why);
  pid_t successor_of(const Child& child);
  bool all_go_on();
  void keep_spares();
  core::Step farthest_step();
  void look_at_nodes();
  bool has_to_stop() const;
  bool any_running() const;
  void stop_all();
  void urge(Child& child, process::NodeEnding& ending);
  std::vector<std::uint32_t> running_regions() const;
  void signal_all(int signal);
  void show();
  command_line::ExitCode conclude();
  command_line::ExitCode report_and_count(command_line::ExitCode so_far);

  const config::Launch& launch_;
  setup::LaunchOptions options_;
  std::uint64_t run_ = dds::draw_id();
  HubProcess hub_;  ///< with discovery: neighbours
  dds::Participant participant_;
  dds::ControlBus control_;
  TerminalView view_;
  std::optional<host::FolderLock> report_folder_;
  host::HeartbeatPipe heartbeats_;
  host::LifeWatch life_;
  process::LongSteps long_steps_;
  std::vector<Child> children_;
  std::vector<pid_t> spares_;
  struct Drain {
    messages::RunCommand command;
    std::chrono::steady_clock::time_point heard;
  };
  std::vector<Drain> drains_;              ///< drain commands for processes that are not known here yet
  std::optional<StartWatch> start_watch_;  ///< set once the nodes are started
  bool has_begun_ = false;                 ///< a node's status has shown that all nodes have met
  bool cannot_begin_ = false;              ///< a node is missing, and the others would wait for it
  bool stopping_ = false;
  bool must_not_go_on_ = false;  ///< a node has died, and no process takes its region over
  bool is_seen_ = true;          ///< false once the table's terminal or pipe is closed
  ViewerProcess viewer_;
};

}  // namespace aurasim::launch
