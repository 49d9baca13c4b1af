// One node as a process: joins the DDS domain, waits for its neighbours, keeps pace, executes run commands, records.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_line/exit_code.h"
#include "config/launch.h"
#include "cut/saved_world.h"
#include "dds/control.h"
#include "node/node.h"
#include "node/pacer.h"
#include "process/fence.h"
#include "process/hold.h"
#include "process/node_endpoints.h"
#include "process/node_options.h"
#include "process/node_phase.h"
#include "process/node_status.h"
#include "process/notices.h"
#include "process/patience.h"
#include "process/records.h"
#include "process/recovery.h"
#include "process/run_control_limits.h"
#include "process/saving.h"
#include "process/setpoint_intake.h"
#include "process/world_meant.h"

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
  dds::ControlBus& control() { return endpoints_.control(); }
  dds::DdsTransport& transport() { return endpoints_.transport(); }
  Checkpoints& checkpoints() { return endpoints_.checkpoints(); }
  FenceSettings fence_settings() const;
  bool fence_is_open();
  command_line::ExitCode meet_and_run();
  command_line::ExitCode take_over();
  bool domain_is_free();
  bool hears_another_node();
  double share_of_nodes();
  bool meet_neighbours();
  bool another_run_is_here();
  bool another_agreement_is_here();
  bool the_same_run_is_here();
  void name_the_dead();
  std::uint64_t met();
  std::string who_does_not_wait();
  void start_when_all_wait();
  void connect_anew(dds::TransportSettings settings, const std::function<void(const char*)>& wait);
  bool wait_for_start();
  /// `begin`: the command that names the start time.
  void begin_generation(core::Generation generation, const messages::RunCommand& begin);
  std::unique_ptr<node::Node> make_node();
  void begin_with(const node::StepReport& report);
  dds::TransportSettings transport_settings();
  command_line::ExitCode run_steps();
  void run_until_end();
  command_line::ExitCode end();
  bool wait_until_due();
  core::Step farthest_paused_step();
  std::chrono::nanoseconds time_until(core::Step step) const;
  void note_strangers();
  void note_waiting();
  bool somebody_computes_for_long();
  void compute_step();
  void execute_commands();
  core::Step first_step() const { return options_.world ? options_.world->step : 0; }
  void compute_until_change();
  void step_back(const RunView& run);
  void send_back(messages::RunCommand restore, const core::Command& back);
  void keep_parts();
  void note_words_of_saves();
  void conclude_saves();
  bool recovers() const { return launch_.recovers(); }
  std::optional<std::string> death();
  void look_for_deaths();
  bool has_successor();
  std::vector<core::RegionId> keepers();
  bool leaves_now() { return drains_ && may_leave(); }
  bool may_leave();
  bool can_leave_to_others();
  void leave_if_asked();
  command_line::ExitCode leave_to_successor();
  void recover(const std::string& why);
  void begin_to_recover();
  bool agree_on_restore();
  void meet_anew();
  void note_unheard(const SeenNodes& nodes);
  bool has_to_leave_recovery(const SeenNodes& nodes);
  RecoveryView recovery_view(const SeenNodes& nodes, bool may_go_on) const;
  SeenNodes nodes_and_self();
  std::string what_recovery_waits_for(const std::vector<core::RegionId>& vacant);
  void give_up(const std::vector<core::RegionId>& vacant);
  void break_off(const std::string& why);
  command_line::ExitCode end_without_world();
  bool call_spare(core::RegionId region);
  void stand_in(const std::vector<core::RegionId>& regions);
  void hear_of_drain(const messages::RunCommand& drain);
  void lead_recovery();
  bool may_begin_again(core::Generation era);
  void hear_of_restore(const messages::RunCommand& restore);
  void hear_of_end(const messages::RunCommand& end);
  void give_way(core::Step step);
  void throw_away_after(core::Step step);
  void repeat_commands(const messages::RunCommand& restore);
  void go_back(const messages::RunCommand& restore);
  void take_map_of(const messages::RunCommand& restore);
  void wait_in_recovery(std::chrono::steady_clock::time_point deadline, const char* for_what);
  core::WorldCut gather(const messages::RunCommand& restore, std::map<core::RegionId, std::string>& parts);
  core::WorldCut decode_part(const std::string& octets) const;
  void record_after(std::optional<core::Step> step);
  void begin_restored(const messages::RunCommand& restore, const core::WorldCut& world,
                      const std::map<core::RegionId, std::string>& parts);
  void serve_clients();
  void take_setpoints();
  bool has_awaited_setpoints();
  void change_rate(double rate);
  void hold_in(core::Step state);
  void step_on(const messages::RunCommand& step);
  void apply_orders();
  void execute(const messages::RunCommand& command);
  Worlds known_worlds() const;
  void obey(const messages::RunCommand& command);
  void obey_early_commands();
  void obey_late_commands();
  bool can_be_meant(const messages::RunCommand& command);
  /// True if another world has begun.
  bool reset_if_due();
  bool change_if_due();
  void change_scene(const std::string& name);
  void change_world(const std::string& file);
  void begin_anew();
  void publish_map(core::Generation generation, core::Step from_step);
  void change_regions(const std::vector<core::Rectangle>& boxes);
  void settle_all();
  void wait_until_all_stand();
  void connect_for_change(const dds::TransportSettings& settings);
  bool finished();
  bool has_reached(core::Step step) const;
  void keep_the_end();
  bool is_about_to_change() const;
  void record(std::span<const node::StepReport> reports);
  void note_redo(const node::StepReport& report);
  void linger();
  bool all_have_left();
  bool has_all_of_the_last_states();
  messages::RunCommand with_clock_of(core::RegionId region, messages::RunCommand command);
  void compare_clocks();
  void enter(NodeEvent event);
  void publish(const std::string& text = {});
  void publish_running();
  command_line::ExitCode refuse(const std::string& why);
  command_line::ExitCode not_begun();
  double real_time_factor() const;

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
  std::vector<core::Order> run_orders_;  ///< orders about the run as a whole that are not due yet
  node::Pacer pacer_;
  core::Generation generation_ = 0;
  std::optional<core::Generation> begun_;  ///< generation that node_ computes in, or has computed in last
  std::optional<core::Step> hold_at_;      ///< paused once this state has been computed
  AskedSteps asked_steps_;                 ///< steps asked for since the run was paused
  PauseFollower pause_follower_;
  std::optional<core::Step> stop_at_;
  std::optional<messages::RunCommand> reset_;
  RunControlLimits run_control_limits_;
  std::optional<messages::RunCommand> start_;
  core::Generation waits_to_start_ = 0;  ///< generation that a start command has to name
  std::optional<core::Order> change_;    ///< order that changes the run as a whole, due now
  struct BeforeChange {
    config::Launch launch;
    std::shared_ptr<const core::WorldCut> world;
  };
  std::optional<BeforeChange> before_change_;    ///< set while a change is under way
  std::vector<messages::RunCommand> early_;      ///< commands of a generation that has not begun here
  std::vector<messages::RunCommand> late_;       ///< commands of generations before restore_'s, received since restore_
  std::optional<messages::RunCommand> restore_;  ///< the newest restore command
  core::Generation restoring_ = 0;               ///< generation that a recovery is about to begin, or has begun
  int failed_changes_ = 0;                       ///< in a row
  core::Generation life_ = 0;          ///< generation with which the run went on after the last death or change
  core::Generation life_of_node_ = 0;  ///< the life_ with which node_ has begun
  bool drains_ = false;                ///< this node gives its region to another process as soon as there is one
  std::optional<std::chrono::steady_clock::time_point> leaves_by_;  ///< asked to leave: the latest time to do so
  std::set<std::uint64_t> leaving_;                                 ///< processes that drain
  std::optional<core::Step> successor_since_;                       ///< state in which the successor was first seen
  std::string broken_off_;          ///< why the run ends before its time: another region's node has died
  bool is_going_back_ = false;      ///< all have agreed on restore_, and not all have begun
  core::Generation stands_in_ = 0;  ///< generation published while waiting in a recovery
  std::chrono::steady_clock::time_point recovering_since_;
  Recovery recovery_;
  std::set<std::uint64_t> taken_;  ///< processes of spares that were called
  std::string asks_for_;           ///< decision that a user has to take before the run can go on; empty: none
  bool stops_standing_ = false;    ///< stopped in a recovery: does not wait for the others
  core::Step hurry_until_ = 0;     ///< a client waits for this state: until then the pace is at least real time
  std::chrono::steady_clock::time_point computed_at_;  ///< when the last state was computed
  std::chrono::steady_clock::time_point began_;
  std::chrono::steady_clock::duration paused_{};
  std::set<core::RegionId> missed_;  ///< regions whose nodes died while the nodes met; each is logged once
};

}  // namespace aurasim::process
