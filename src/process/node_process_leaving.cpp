// How a node leaves the run and how regions get other processes. The decisions are in leaving.h and recovery.h.
#include <spdlog/spdlog.h>

#include "host/other_role.h"
#include "host/spawn.h"
#include "host/stop_signal.h"
#include "process/node_process.h"
#include "steering/run_steering.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

void NodeProcess::call_spare(core::RegionId region) {
  const auto process = recovery_.call_spare(control().spares(), region, Clock::now());
  if (!process) return;
  control().send(steering::about_process(messages::RunCommandKind::kTake, options_.run, region, *process));
}

/// Executes a drain command: a node is to leave. Its launcher starts a successor. If nodes were started by hand, the
/// lowest region calls a spare; if there is none, the host of the next region starts a process.
void NodeProcess::execute_drain(const messages::RunCommand& drain) {
  const SeenNodes& nodes = control().statuses();
  if (!recovers() || !leaving_.note_drain(drain, nodes) || options_.has_launcher) return;
  const bool is_self = drain.region == options_.region && drain.process == status_.content().process;
  if (!control().spares().empty()) {
    if (endpoints_.leads()) call_spare(drain.region);
  } else if (!is_self && recovery_.is_next_after(drain.region, recovery_view(nodes, true))) {
    spdlog::info("the node of region {} is to leave: this host takes it over, beside region {}",
                 core::value_of(drain.region), core::value_of(options_.region));
    spawn_successor(drain.region);
  }
}

/// Starts a second process on this host, which takes the region over.
void NodeProcess::spawn_successor(core::RegionId region) {
  host::spawn_apart(host::words_of_successor(host::own_words(), region, options_.run));
}

/// Begins to leave after a SIGTERM.
void NodeProcess::leave_if_asked() {
  if (!host::asked_to_leave() || leaving_.has_begun()) return;
  leaving_.begin(Clock::now());
  const messages::RunCommand drain = steering::about_process(messages::RunCommandKind::kDrain, options_.run,
                                                             options_.region, status_.content().process);
  control().send(drain);
  execute_drain(drain);
}

/// True if another node stays that can go on with this node's world.
bool NodeProcess::can_leave_to_others() { return recovers() && leaving_.can_leave_to_others(control().statuses()); }

/// True if this node gives its region to another process and that costs the run least now.
bool NodeProcess::leaves_now() {
  if (!leaving_.drains()) return false;
  const std::vector<messages::KeptPart> parts = checkpoints().parts();
  const KeptView kept = {node_->current_step(), phase_ == NodePhase::kPaused, parts, checkpoints().keepers()};
  return leaving_.may_leave(has_successor(control().strangers(), status_.content()), kept, control().statuses());
}

/// Leaves the region to a successor. To the others it is as a death.
command_line::ExitCode NodeProcess::leave_to_successor() {
  const bool is_taken = has_successor(control().strangers(), status_.content());
  spdlog::info("region {} leaves after state {}: {}", core::value_of(options_.region), node_->current_step(),
               is_taken ? "another process takes over" : "nobody has come to take over yet");
  control().send(steering::about_process(messages::RunCommandKind::kLost, options_.run, options_.region,
                                         status_.content().process));
  return command_line::ExitCode::kOk;
}

}  // namespace aurasim::process
