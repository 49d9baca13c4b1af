// How a node executes run commands (command_queue.h, run_schedule.h), and how it serves clients.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "process/node_process.h"
#include "process/run_view.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

void NodeProcess::execute_commands() {
  for (const messages::RunCommand& command : control().take_commands()) execute(command);
}

void NodeProcess::execute(const messages::RunCommand& command) {
  using Kind = messages::RunCommandKind;
  switch (command.kind) {
    case Kind::kStart:
      if (!start_.is_awaited(command) || !is_plausible(command)) return;
      return start_.accept(with_clock_of(control().statuses(), core::RegionId{0}, command));
    case Kind::kLost:
      return control().hear_of_death(command);
    case Kind::kRestore:
      if (is_plausible(command)) execute_restore(command);
      return;
    case Kind::kDrain:
      return execute_drain(command);
    case Kind::kTake:
      return;  // for spares only
    case Kind::kEnd:
      return execute_end(command);
    case Kind::kPause:
    case Kind::kResume:
    case Kind::kStep:
    case Kind::kReset:
    case Kind::kStop:
    case Kind::kRate:
      if (commands_.is_for_now(command, known_worlds()) && node_ && is_plausible(command)) apply(command);
      return;
  }
}

/// Executes `end`: another node has given up waiting for a process that takes a region over. This node ends only if it
/// waits, too.
void NodeProcess::execute_end(const messages::RunCommand& end) {
  const bool waits = phase_ == NodePhase::kRecovering || phase_ == NodePhase::kSpare;
  if (!waits || !is_plausible(end)) return;
  break_off(fmt::format("nobody takes over region {}, whose node has died", core::value_of(end.region)));
}

/// The generations that this node knows.
Worlds NodeProcess::known_worlds() const {
  Worlds known;
  if (phase_ == NodePhase::kWaiting) known.waits_for = generation_;
  if (restoration_.restore()) known.restored = restoration_.restore()->generation;
  if (const auto reset_of = schedule_.reset_of()) known.reset_to = *reset_of + 1;
  return known;
}

/// Applies a command to the world that this node computes.
void NodeProcess::apply(const messages::RunCommand& command) {
  schedule_.apply(command, node::read_clocks());
  if (command.kind == messages::RunCommandKind::kStop) restoration_.note_stop(phase_ == NodePhase::kRecovering);
  const bool steps = command.kind == messages::RunCommandKind::kStep && schedule_.holds_at().has_value();
  if (steps && !schedule_.is_held_in(node_->current_step())) setpoints_.await(command, Clock::now());
}

/// Sends a command to all nodes and executes it here.
void NodeProcess::command_all(messages::RunCommand command) {
  command.generation = generation_;
  command.request = 0;
  command.request = control().send(command);
  execute(command);
}

/// Executes the commands for this world that came before it began here.
void NodeProcess::execute_early_commands() {
  for (const messages::RunCommand& command : commands_.take_early(generation_)) execute(command);
}

/// Handles commands for the world that all have left. The node that sent the restore sends them once more, and all
/// execute those.
void NodeProcess::execute_late_commands() {
  for (const messages::RunCommand& command : commands_.take_late()) {
    if (restoration_.restore()->region == options_.region) command_all(command);
  }
}

/// True if the command is plausible. Otherwise it is refused, and counted against its sender.
bool NodeProcess::is_plausible(const messages::RunCommand& command) {
  const core::Generation newest = std::max(restoration_.newest(generation_), status_.content().era);
  const std::string why = commands_.problem_with(command, newest, node::wall_clock_ns());
  if (!why.empty()) control().refuse(command, why);
  return why.empty();
}

/// True if another world has begun.
bool NodeProcess::reset_if_due() {
  if (!schedule_.reset_is_due(node_->current_step())) return false;
  const bool stands = schedule_.holds_at().has_value();
  const messages::RunCommand reset = schedule_.take_reset();
  enter(NodeEvent::kReset);
  begin_generation(reset.generation + 1, reset);
  if (stands) schedule_.hold_in(node_->current_step());
  status_.make_due();  // the client waits for this status
  return true;
}

/// Serves clients' commands. The lead gives orders their state.
void NodeProcess::serve_clients() {
  if (changes_.is_about_to_change(node_->current_step())) return;
  const RunView run = view_of_run(control().statuses(), status_.content(), schedule_.holds_at());
  endpoints_.commands().serve(*node_, run);
  saving_.save_as_it_stands(*node_, endpoints_.commands());
  if (run.leads) {
    saving_.save_regularly(*node_, first_step());
    compute_until_change();
    step_back(run);
  }
  status_.content().meshes = endpoints_.commands().meshes();
  // A run command and no order, because steps may be seconds apart.
  if (const std::optional<double> rate = endpoints_.commands().take_wanted_rate()) {
    command_all(schedule_.rate_command(*rate, node_->current_step(), node::wall_clock_ns()));
  }
}

/// Makes a paused run compute up to a change. All nodes pause again in the first state of the new world.
void NodeProcess::compute_until_change() {
  const std::optional<core::Step> change = endpoints_.commands().change_at();
  if (!change) return;
  auto steps = schedule_.steps_to(*change, node_->current_step(), node_->confirmed_step(), node::wall_clock_ns());
  if (!steps) return;
  steps->run = options_.run;
  command_all(*steps);
}

}  // namespace aurasim::process
