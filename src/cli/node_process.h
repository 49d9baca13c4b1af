// One node as a process: joins the DDS domain, waits for its neighbours, keeps pace, executes run commands, records.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command_server.h"
#include "cli/fence.h"
#include "cli/replica_publisher.h"
#include "config/launch.h"
#include "dds/control.h"
#include "dds/dds_transport.h"
#include "dds/participant.h"
#include "node/node.h"
#include "node/pacer.h"
#include "node/recorder.h"

namespace aurasim::cli {

/// How a process ended; also its exit code.
enum class ExitCode : int {
  kOk = 0,
  kFailed = 1,     ///< something broke, a node died or a body was lost
  kBadConfig = 2,  ///< the files or the command line are wrong
  kRefused = 3,    ///< another run is in the same domain, or a neighbour did not come in time
  kFenced = 4,     ///< the others hold this node for dead, or may (fence.h)
};

struct NodeOptions {
  core::RegionId region{};
  std::optional<core::Step> steps;  ///< stop after this state; nothing: run until told to stop
  std::optional<std::filesystem::path> report;
  std::chrono::seconds start_time_out{30};
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

  ExitCode meet_and_run();
  bool domain_is_free();
  bool meet_neighbours();
  bool another_run_is_here();
  bool this_region_is_taken();
  void start_when_all_wait();
  bool wait_for_start();
  void begin_generation(core::Generation generation, std::int64_t epoch_ns);
  ExitCode run_steps();
  bool wait_until_due();
  void compute_step();
  void execute_commands();
  void serve_clients();
  void apply_orders();
  void execute(const dds::RunCommand& command);
  void reset_if_due();
  void change_if_due();
  void change_scene(const std::string& name);
  void change_regions(const std::vector<core::Rectangle>& boxes);
  void settle_all();
  void wait_until_all_stand();
  void connect_anew(const dds::TransportSettings& settings);
  bool finished() const;
  void linger();
  void publish(dds::NodeState state, const std::string& text = {});
  void publish_running();
  void note(const node::StepReport& report, double frame_ms);
  ExitCode refuse(const std::string& why);
  double real_time_factor() const;

  config::Launch launch_;
  NodeOptions options_;
  dds::Participant participant_;
  dds::ControlBus control_;
  Fence fence_;
  std::optional<dds::DdsTransport> transport_;   ///< once the domain is known to be free
  std::optional<ReplicaPublisher> observers_;    ///< likewise
  std::optional<CommandServer> command_server_;  ///< likewise
  std::vector<core::Order> run_orders_;          ///< about the run as a whole, not yet due
  std::unique_ptr<node::Node> node_;
  std::unique_ptr<node::Recorder> recorder_;
  node::Pacer pacer_;
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
  std::chrono::steady_clock::time_point began_;
  std::chrono::steady_clock::duration paused_{};
  std::chrono::steady_clock::time_point last_published_;
};

}  // namespace aurasim::cli
