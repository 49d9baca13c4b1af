#include "process/succession.h"

#include <spdlog/spdlog.h>

#include "host/other_role.h"
#include "host/spawn.h"
#include "host/stop_signal.h"
#include "steering/run_steering.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

void Succession::call_spare(core::RegionId region) {
  const auto process = run_.recovery.call_spare(run_.control().spares(), region, Clock::now());
  if (!process) return;
  run_.control().send(steering::about_process(messages::RunCommandKind::kTake, run_.options.run, region, *process));
}

void Succession::spawn_successor(core::RegionId region) {
  host::spawn_apart(host::words_of_successor(host::own_words(), region, run_.options.run));
}

void Succession::execute_drain(const messages::RunCommand& drain) {
  const SeenNodes& nodes = run_.control().statuses();
  if (!run_.recovers() || !run_.leaving.note_drain(drain, nodes) || run_.options.has_launcher) return;
  const bool is_self = drain.region == run_.options.region && drain.process == run_.status.content().process;
  if (!run_.control().spares().empty()) {
    if (run_.endpoints.leads()) call_spare(drain.region);
  } else if (!is_self && run_.recovery.is_next_after(drain.region, run_.recovery_view(nodes, true))) {
    spdlog::info("the node of region {} is to leave: this host takes it over, beside region {}",
                 core::value_of(drain.region), core::value_of(run_.options.region));
    spawn_successor(drain.region);
  }
}

void Succession::leave_if_asked() {
  if (!host::asked_to_leave() || run_.leaving.has_begun()) return;
  run_.leaving.begin(Clock::now());
  const messages::RunCommand drain = steering::about_process(messages::RunCommandKind::kDrain, run_.options.run,
                                                             run_.options.region, run_.status.content().process);
  run_.control().send(drain);
  execute_drain(drain);
}

bool Succession::can_leave_to_others() {
  return run_.recovers() && run_.leaving.can_leave_to_others(run_.control().statuses());
}

bool Succession::leaves_in_vain() {
  return run_.leaving.has_begun() && (!can_leave_to_others() || run_.leaving.is_overdue(Clock::now()));
}

bool Succession::leaves_now() {
  if (!run_.leaving.drains()) return false;
  const std::vector<messages::KeptPart> parts = run_.checkpoints().parts();
  const KeptView kept = {run_.node->current_step(), run_.phase == NodePhase::kPaused, parts,
                         run_.checkpoints().keepers()};
  return run_.leaving.may_leave(has_successor(run_.control().strangers(), run_.status.content()), kept,
                                run_.control().statuses());
}

command_line::ExitCode Succession::leave_to_successor() {
  const bool is_taken = has_successor(run_.control().strangers(), run_.status.content());
  spdlog::info("region {} leaves after state {}: {}", core::value_of(run_.options.region), run_.node->current_step(),
               is_taken ? "another process takes over" : "no process has taken the region over yet");
  run_.control().send(steering::about_process(messages::RunCommandKind::kLost, run_.options.run, run_.options.region,
                                              run_.status.content().process));
  return command_line::ExitCode::kOk;
}

}  // namespace aurasim::process
