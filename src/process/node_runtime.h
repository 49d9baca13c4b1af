// The parts of a node's process that all its phases share, and operations on several of them at once, such as the
// beginning of a world or the publication of the status. The phases (meeting_phase.h, changing_phase.h,
// recovering_phase.h, ending_phase.h) and the loop (node_process.h) wait and decide the order; nothing here waits.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/launch.h"
#include "node/node.h"
#include "process/command_queue.h"
#include "process/exchange_watch.h"
#include "process/fence.h"
#include "process/leaving.h"
#include "process/meeting.h"
#include "process/node_endpoints.h"
#include "process/node_options.h"
#include "process/node_phase.h"
#include "process/node_status.h"
#include "process/notices.h"
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

struct NodeRuntime {
  using Clock = std::chrono::steady_clock;

  NodeRuntime(config::Launch the_launch, const NodeOptions& the_options);
  NodeRuntime(const NodeRuntime&) = delete;
  NodeRuntime& operator=(const NodeRuntime&) = delete;

  dds::ControlBus& control() { return endpoints.control(); }
  dds::DdsTransport& transport() { return endpoints.transport(); }
  Checkpoints& checkpoints() { return endpoints.checkpoints(); }
  bool recovers() const { return launch.recovers(); }
  /// State that the run began with.
  core::Step first_step() const { return options.world ? options.world->step : 0; }
  core::Step present_step() const { return node ? node->current_step() : first_step(); }

  void enter(NodeEvent event);
  /// Logs and publishes why this node refuses to run.
  void refuse(const std::string& why);
  bool fence_is_open();
  dds::TransportSettings transport_settings();
  /// Publishes the map and scene of a generation. The agreement stays that of the run's beginning.
  void publish_map(core::Generation of, core::Step from_step);

  // The exchange, where the launch file says `auto`
  /// From now on this is the run's exchange.
  void use_exchange(config::Exchange exchange);
  /// Uses the exchange that live nodes of the run have chosen, if it is not known here and any has.
  void take_exchange_of_others();
  /// Counts the exchanges of the last state where regions are coupled.
  void note_exchanges(Clock::time_point now);

  // Connecting for a generation
  /// Region 0 sends the awaited start once every region waits for it.
  void start_when_all_wait();
  /// Makes endpoints for the awaited generation. They match only endpoints of the same generation, and not those of
  /// dead processes or those that others are about to drop, where messages would be lost.
  void begin_to_connect(dds::TransportSettings settings);
  /// Goes on after begin_to_connect(). Returns what the node waits for; null once the awaited generation has started.
  const char* go_on_connecting();

  // Deaths, and the way out of a run
  /// Why this node must not compute its next state (why_stand).
  std::optional<std::string> death();
  /// To be called while all wait for each other. Throws SomebodyDied if a node has died.
  void look_for_deaths();
  /// The statuses of all nodes, with this node's own as the others see it.
  SeenNodes nodes_and_self();
  RecoveryView recovery_view(const SeenNodes& nodes, bool may_go_on) const;
  /// Ends the run on this node before its time, and names the newest saved world.
  void break_off(const std::string& why);
  /// Closes the fence, because another process has this region since state `step`.
  void give_way(core::Step step);
  /// Sends a restore command to all nodes and accepts it here, and sends the commands that it would undo once more.
  void send_restore(messages::RunCommand restore);

  // The world (node_runtime_world.cpp)
  /// Begins the world of a generation. `begin`: the command that names its start time.
  void begin_generation(core::Generation next, const messages::RunCommand& begin);
  /// Begins with the world that all have gone back to. `parts`: its parts by region.
  void begin_restored(const messages::RunCommand& restore, const core::WorldCut& world,
                      const std::map<core::RegionId, std::string>& parts);
  /// Goes on in the present state with the regions of `launch`, in the generation that has started.
  void begin_changed_map();
  /// Records states that are confirmed.
  void record(std::span<const node::StepReport> reports);
  /// Opens the records to go on after state `step`. The run goes on even if that fails.
  void record_after(std::optional<core::Step> step);
  /// Keeps what the node has completed, and replies to clients.
  void keep_parts();
  /// The last message about saves goes into the status.
  void note_messages_of_saves();
  /// Finishes all saves at the end of the run.
  void conclude_saves();
  /// True if the state has been computed and is confirmed.
  bool has_reached(core::Step step) const;
  /// True if the last state of the run is known, computed and confirmed.
  bool has_reached_the_end() const;

  // The status (node_runtime_status.cpp)
  /// Publishes the status with this text, if it is due.
  void publish(const std::string& text = {});
  /// Publishes the status of a node that computes, if its period is over.
  void publish_running();
  Awaited awaited_of_status() const;
  /// Simulated seconds per second since the world began, pauses left out.
  double real_time_factor() const;

  NodePhase phase = NodePhase::kListening;
  config::Launch launch;
  NodeOptions options;
  NodeEndpoints endpoints;
  Fence fence;
  std::unique_ptr<node::Node> node;
  Saving saving;
  Records records;
  Notices notices;
  NodeStatus status;
  ExchangeWatch exchange_watch;
  SetpointIntake setpoints;
  RunSchedule schedule;
  CommandQueue command_queue;
  RunChanges changes;
  AwaitedStart start;
  Leaving leaving;
  Recovery recovery;
  Restoration restoration;
  core::Generation generation = 0;
  core::Generation life = 0;          ///< generation with which the run went on after the last death or change
  core::Generation life_of_node = 0;  ///< the life with which `node` has begun

 private:
  std::unique_ptr<node::Node> make_node();
  void begin_with(const node::StepReport& report);
  std::vector<core::RegionId> keepers();
  void throw_away_after(core::Step step);
  void note_strangers();
};

}  // namespace aurasim::process
