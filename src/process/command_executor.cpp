#include "process/command_executor.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/wall_clock.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

void CommandExecutor::execute_commands() {
  for (const messages::RunCommand& command : run_.control().take_commands()) execute(command);
}

void CommandExecutor::execute(const messages::RunCommand& command) {
  using Kind = messages::RunCommandKind;
  switch (command.kind) {
    case Kind::kStart:
      if (!run_.start.is_awaited(command) || !is_plausible(command)) return;
      return run_.start.accept(with_clock_of(run_.control().statuses(), core::RegionId{0}, command));
    case Kind::kLost:
      return run_.control().receive_death(command);
    case Kind::kRestore:
      if (is_plausible(command)) execute_restore(command);
      return;
    case Kind::kDrain:
      return succession_.execute_drain(command);
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
      if (run_.command_queue.is_for_now(command, known_worlds()) && run_.node && is_plausible(command)) apply(command);
      return;
  }
}

/// Executes `end`: another node has given up waiting for a process that takes a region over. This node ends only if it
/// waits, too.
void CommandExecutor::execute_end(const messages::RunCommand& end) {
  const bool waits = run_.phase == NodePhase::kRecovering || run_.phase == NodePhase::kSpare;
  if (!waits || !is_plausible(end)) return;
  run_.break_off(fmt::format("nobody takes over region {}, whose node has died", core::value_of(end.region)));
}

/// Executes a restore command. It names the processes that go on, so this process may be left out of the run.
void CommandExecutor::execute_restore(const messages::RunCommand& restore) {
  if (restore.members.size() != run_.launch.regions.size()) return;
  const core::Generation begun = run_.node ? run_.generation : 0;
  switch (
      run_.restoration.meaning(restore, run_.options.region, run_.status.content().process, run_.generation, begun)) {
    case RestoreMeaning::kNothing:
      break;
    case RestoreMeaning::kGoBack:
      run_.restoration.use(with_clock_of(run_.control().statuses(), restore.region, restore));
      break;
    case RestoreMeaning::kLeftOut:
      run_.recovery.note_left_out(restore);
      break;
    case RestoreMeaning::kReplaced:
      if (run_.node) run_.give_way(restore.at_step);
      break;
  }
}

/// The generations that this node knows.
Worlds CommandExecutor::known_worlds() const {
  Worlds known;
  if (run_.phase == NodePhase::kWaiting) known.waits_for = run_.generation;
  if (run_.restoration.restore()) known.restored = run_.restoration.restore()->generation;
  if (const auto reset_of = run_.schedule.reset_of()) known.reset_to = *reset_of + 1;
  return known;
}

/// Applies a command to the world that this node computes.
void CommandExecutor::apply(const messages::RunCommand& command) {
  run_.schedule.apply(command, node::read_clocks());
  if (command.kind == messages::RunCommandKind::kStop) run_.restoration.note_stop(run_.phase == NodePhase::kRecovering);
  const bool steps = command.kind == messages::RunCommandKind::kStep && run_.schedule.holds_at().has_value();
  if (steps && !run_.schedule.is_held_in(run_.node->current_step())) run_.setpoints.await(command, Clock::now());
}

void CommandExecutor::command_all(messages::RunCommand command) {
  command.generation = run_.generation;
  command.request = 0;
  command.request = run_.control().send(command);
  execute(command);
}

void CommandExecutor::execute_early_commands() {
  for (const messages::RunCommand& command : run_.command_queue.take_early(run_.generation)) execute(command);
}

void CommandExecutor::execute_late_commands() {
  for (const messages::RunCommand& command : run_.command_queue.take_late()) {
    if (run_.restoration.restore()->region == run_.options.region) command_all(command);
  }
}

/// True if the command is plausible. Otherwise it is refused, and counted against its sender.
bool CommandExecutor::is_plausible(const messages::RunCommand& command) {
  const core::Generation newest = std::max(run_.restoration.newest(run_.generation), run_.status.content().era);
  const std::string why = run_.command_queue.problem_with(command, newest, core::wall_clock_ns());
  if (!why.empty()) run_.control().refuse(command, why);
  return why.empty();
}

bool CommandExecutor::reset_if_due() {
  if (!run_.schedule.reset_is_due(run_.node->current_step())) return false;
  const bool was_paused = run_.schedule.holds_at().has_value();
  const messages::RunCommand reset = run_.schedule.take_reset();
  run_.enter(NodeEvent::kReset);
  run_.begin_generation(reset.generation + 1, reset);
  if (was_paused) run_.schedule.hold_in(run_.node->current_step());
  run_.status.make_due();  // the client waits for this status
  return true;
}

}  // namespace aurasim::process
