// One node as a process: joins the DDS domain, waits for its neighbours, keeps pace, executes run commands, records.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cli/command_server.h"
#include "cli/exit_code.h"
#include "cli/fence.h"
#include "cli/node_phase.h"
#include "cli/replica_publisher.h"
#include "cli/saved_world.h"
#include "config/launch.h"
#include "dds/control.h"
#include "dds/dds_transport.h"
#include "dds/participant.h"
#include "node/node.h"
#include "node/pacer.h"
#include "node/recorder.h"

namespace aurasim::cli {

struct NodeOptions {
  core::RegionId region{};
  std::uint64_t run = 0;            ///< the same number for all nodes of a run and no other; 0: nobody has drawn one
  std::optional<core::Step> steps;  ///< stop after this state; nothing: run until told to stop
  std::optional<std::filesystem::path> report;
  std::chrono::seconds start_time_out{30};
  std::shared_ptr<const core::WorldCut> world;  ///< saved: the run goes on from it, and comes back to it when reset
  std::filesystem::path saves = "saves";        ///< where it writes its parts of saved worlds
  core::Step save_every = 0;                    ///< states; 0: only when somebody asks for it
};

/// Between a region and those that have to hear of it.
dds::TransportSettings neighbour_transport(const config::Launch& launch, core::RegionId region);

class NodeProcess {
 public:
  NodeProcess(const config::Launch& launch, const NodeOptions& options);

  ExitCode run();

 private:
  struct Window {  ///< of about the last second, milliseconds
    std::vector<double> frame, physics, protocol, transport;
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  };

  FenceSettings fence_settings() const;
  std::map<core::RegionId, node::PeerSign> peer_signs();
  bool fence_is_open();
  ExitCode meet_and_run();
  bool domain_is_free();
  bool meet_neighbours();
  bool another_run_is_here();
  bool another_agreement_is_here();
  bool the_same_run_is_here();
  void name_the_dead();
  void start_when_all_wait();
  bool wait_for_start();
  /// `begin`: the command that names when.
  void begin_generation(core::Generation generation, const dds::RunCommand& begin);
  ExitCode run_steps();
  bool wait_until_due();
  std::chrono::nanoseconds time_until(core::Step step) const;
  void note_refusals();
  void note_waiting();
  void note_faults(const node::StepReport& report);
  void compute_step();
  void execute_commands();
  core::Step first_step() const { return options_.world ? options_.world->step : 0; }
  void save_parts();
  void save_regularly();
  void serve_clients();
  void change_rate(double rate);
  void apply_orders();
  void execute(const dds::RunCommand& command);
  void reset_if_due();
  void change_if_due();
  void change_scene(const std::string& name);
  void change_world(const std::string& file);
  void begin_anew();
  void change_regions(const std::vector<core::Rectangle>& boxes);
  void settle_all();
  void wait_until_all_stand();
  void connect_anew(const dds::TransportSettings& settings);
  bool finished() const;
  bool has_reached(core::Step step) const;
  void keep_the_end();
  bool is_about_to_change() const;
  void record(std::span<const node::StepReport> reports);
  void note_redo(const node::StepReport& report);
  void linger();
  dds::RunCommand with_clock_of_region_zero(dds::RunCommand start);
  void compare_clocks();
  void watch_the_clock();
  void watch_the_records();
  void enter(NodeEvent event);
  void publish(const std::string& text = {});
  void publish_running();
  void note(const node::StepReport& report, double frame_ms);
  ExitCode refuse(const std::string& why);
  ExitCode not_begun();
  double real_time_factor() const;

  NodePhase phase_ = NodePhase::kListening;
  config::Launch launch_;
  NodeOptions options_;
  dds::Participant participant_;
  dds::ControlBus control_;
  Fence fence_;
  std::optional<dds::DdsTransport> transport_;   ///< once the domain is known to be free
  std::optional<ReplicaPublisher> observers_;    ///< likewise
  std::optional<CommandServer> command_server_;  ///< likewise
  std::vector<core::Order> run_orders_;          ///< about the run as a whole, not yet due
  PartWriter saves_;
  core::Step saved_last_ = 0;  ///< state of the last save that nobody has asked for, on the lead
  std::unique_ptr<node::Node> node_;
  std::unique_ptr<node::Recorder> recorder_;
  node::Pacer pacer_;
  node::ClockWatch clock_watch_{node::read_clocks()};
  bool says_records_end_ = false;
  std::string notice_;  ///< for people, in the status while the node runs
  core::Generation generation_ = 0;
  std::optional<core::Step> hold_at_;  ///< paused once this state has been computed
  std::optional<core::Step> stop_at_;
  std::optional<dds::RunCommand> reset_;
  std::optional<dds::RunCommand> start_;
  core::Generation waits_to_start_ = 0;  ///< the generation that a start command has to name
  std::optional<core::Order> change_;    ///< of the run as a whole, due now
  dds::Status status_;
  Window window_;
  double wait_ms_ = 0;
  std::map<core::Step, node::FrameTimes> frame_times_;  ///< of states that are not recorded yet
  core::Step hurry_until_ = 0;       ///< somebody waits for this state: no slower than in real time until then
  std::size_t refusals_noted_ = 0;   ///< of the protocol's
  std::uint64_t broken_bodies_ = 0;  ///< taken out here since the start
  std::string fault_;                ///< the last one, for people
  std::string waiting_;              ///< whom for, if it takes long
  std::optional<std::chrono::steady_clock::time_point> waiting_since_;
  std::chrono::steady_clock::time_point computed_at_;  ///< the last state
  std::chrono::steady_clock::time_point began_;
  std::chrono::steady_clock::duration paused_{};
  std::chrono::steady_clock::time_point last_published_;
  std::set<core::RegionId> missed_;  ///< died while the nodes met, and said so
};

}  // namespace aurasim::cli
