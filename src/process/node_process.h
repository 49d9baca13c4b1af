// One node as a process: joins the DDS domain, waits for its neighbours, computes states at their time, executes run
// commands, records, and recovers with the others when a node dies. It is a loop over parts. Each part owns its state
// and decides; this class waits, sends and receives (docs/architecture.md, "A process").
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_line/exit_code.h"
#include "config/launch.h"
#include "host/long_work.h"
#include "node/node.h"
#include "process/command_queue.h"
#include "process/fence.h"
#include "process/leaving.h"
#include "process/meeting.h"
#include "process/node_endpoints.h"
#include "process/node_options.h"
#include "process/node_phase.h"
#include "process/node_status.h"
#include "process/notices.h"
#include "process/patience.h"
#include "process/records.h"
#include "process/recovery.h"
#include "process/restoration.h"
#include "process/run_changes.h"
#include "process/run_schedule.h"
#include "process/saving.h"
#include "process/setpoint_intake.h"

namespace aurasim::process {

/// Thrown when a node has died while all nodes were about to act together. All nodes then go back to a state that is
/// kept.
class SomebodyDied : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class NodeProcess {
 public:
  NodeProcess(const config::Launch& launch, const NodeOptions& options);

  command_line::ExitCode run();
  /// To be called after run(). True if another process has this region now, so that this process may serve the run as a
  /// spare.
  bool comes_back_as_spare() const;

 private:
  using Clock = std::chrono::steady_clock;

  dds::ControlBus& control() { return endpoints_.control(); }
  dds::DdsTransport& transport() { return endpoints_.transport(); }
  Checkpoints& checkpoints() { return endpoints_.checkpoints(); }
  bool recovers() const { return launch_.recovers(); }
  core::Step first_step() const { return options_.world ? options_.world->step : 0; }
  core::Step present_step() const { return node_ ? node_->current_step() : first_step(); }

  // The loop (node_process.cpp)
  FenceSettings fence_settings() const;
  bool fence_is_open();
  command_line::ExitCode meet_and_run();
  command_line::ExitCode take_over();
  command_line::ExitCode refuse(const std::string& why);
  command_line::ExitCode not_begun();
  void enter(NodeEvent event);
  dds::TransportSettings transport_settings();
  std::unique_ptr<node::Node> make_node();
  /// `begin`: the command that names the start time.
  void begin_generation(core::Generation generation, const messages::RunCommand& begin);
  void begin_with(const node::StepReport& report);
  void record(std::span<const node::StepReport> reports);
  command_line::ExitCode run_steps();
  void run_until_end();
  bool wait_until_due();
  void wait_in_pause();
  void compute_step();
  void note_redo(const node::StepReport& report);
  void take_setpoints();
  bool has_awaited_setpoints();
  void note_waiting();

  // Meeting (node_process_meeting.cpp)
  bool domain_is_free();
  bool another_run_is_here();
  bool hears_another_node();
  bool meet_neighbours();
  bool wait_for_start();
  void note_meeting(Patience& patience, host::LongWork& waiting);
  void log_early_deaths();
  void start_when_all_wait();
  void begin_to_connect(dds::TransportSettings settings);
  const char* go_on_connecting();

  // Run commands and clients (node_process_commands.cpp)
  void execute_commands();
  void execute(const messages::RunCommand& command);
  void execute_end(const messages::RunCommand& end);
  void apply(const messages::RunCommand& command);
  void command_all(messages::RunCommand command);
  void execute_early_commands();
  void execute_late_commands();
  bool is_plausible(const messages::RunCommand& command);
  Worlds known_worlds() const;
  bool reset_if_due();
  void serve_clients();
  void compute_until_change();

  // Changes of the run as a whole (node_process_changes.cpp)
  void take_reached_changes();
  bool change_if_due();
  void change_scene(const std::string& name);
  void change_world(const std::string& file);
  void change_regions(const std::vector<core::Rectangle>& boxes);
  void begin_anew();
  void publish_map(core::Generation generation, core::Step from_step);
  void wait_until_all_stand();
  void settle_all();
  void connect_for_change(const dds::TransportSettings& settings);
  void begin_changed_map();

  // Kept parts and saved worlds (node_process_keeping.cpp)
  void keep_parts();
  void note_words_of_saves();
  void conclude_saves();
  void step_back(const RunView& run);
  void send_back(messages::RunCommand restore, const core::Command& back);
  std::vector<core::RegionId> keepers();

  // Recovery (node_process_recovery.cpp)
  std::optional<std::string> death();
  void look_for_deaths();
  void recover(const std::string& why);
  void begin_to_recover();
  bool agree_on_restore();
  void execute(const RecoveryActs& acts);
  void join_anew();
  bool has_to_leave_recovery(const SeenNodes& nodes);
  RecoveryView recovery_view(const SeenNodes& nodes, bool may_go_on) const;
  SeenNodes nodes_and_self();
  void give_up(const std::vector<core::RegionId>& vacant);
  void break_off(const std::string& why);
  void lead_recovery();
  void send_restore(messages::RunCommand restore);
  bool may_begin_again(core::Generation era);
  void execute_restore(const messages::RunCommand& restore);
  void give_way(core::Step step);
  void throw_away_after(core::Step step);

  // The way back to a kept state (node_process_restore.cpp)
  void go_back();
  void take_map_of(const messages::RunCommand& restore);
  void wait_in_recovery(Clock::time_point deadline, const char* for_what);
  void record_after(std::optional<core::Step> step);
  void begin_restored(const messages::RunCommand& restore, const core::WorldCut& world,
                      const std::map<core::RegionId, std::string>& parts);

  // Other processes for a region (node_process_leaving.cpp)
  void call_spare(core::RegionId region);
  void spawn_successor(core::RegionId region);
  void execute_drain(const messages::RunCommand& drain);
  void leave_if_asked();
  bool can_leave_to_others();
  bool leaves_now();
  command_line::ExitCode leave_to_successor();

  // The status (node_process_status.cpp)
  void publish(const std::string& text = {});
  void publish_running();
  void note_strangers();
  double real_time_factor() const;

  // The end (node_process_end.cpp)
  bool finished();
  bool has_reached(core::Step step) const;
  bool has_reached_the_end() const;
  void keep_the_end();
  command_line::ExitCode end();
  command_line::ExitCode end_without_world();
  void linger();
  bool others_have_left();
  bool has_all_of_the_last_states();

  NodePhase phase_ = NodePhase::kListening;
  config::Launch launch_;
  NodeOptions options_;
  NodeEndpoints endpoints_;
  Fence fence_;
  std::unique_ptr<node::Node> node_;
  Saving saving_;
  Records records_;
  Notices notices_;
  NodeStatus status_;
  SetpointIntake setpoints_;
  RunSchedule schedule_;
  CommandQueue commands_;
  RunChanges changes_;
  AwaitedStart start_;
  EarlyDeaths early_deaths_;
  Leaving leaving_;
  Recovery recovery_;
  Restoration restoration_;
  core::Generation generation_ = 0;
  core::Generation life_ = 0;          ///< generation with which the run went on after the last death or change
  core::Generation life_of_node_ = 0;  ///< the life_ with which node_ has begun
};

}  // namespace aurasim::process
