// How a node executes run commands: the world that a command is meant for, and its effect. Also how it serves clients.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "process/node_process.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kRateNoticeS = 0.1;

}  // namespace

void NodeProcess::execute(const messages::RunCommand& command) {
  using Kind = messages::RunCommandKind;
  if (command.kind == Kind::kStart) {
    const bool is_awaited = !start_ && command.generation == waits_to_start_;
    if (is_awaited && can_be_meant(command)) start_ = with_clock_of(core::RegionId{0}, command);
    return;
  }
  if (command.kind == Kind::kLost) return control().hear_of_death(command);
  if (command.kind == Kind::kRestore) {
    if (can_be_meant(command)) hear_of_restore(command);
    return;
  }
  if (command.kind == Kind::kDrain) return hear_of_drain(command);
  if (command.kind == Kind::kTake) return;  // for spares only
  if (command.kind == Kind::kEnd) return hear_of_end(command);
  switch (world_meant(command.generation, known_worlds())) {
    case WorldMeant::kPresent:
      if (node_ && can_be_meant(command)) obey(command);
      break;
    case WorldMeant::kNext:
      early_.push_back(command);
      break;
    case WorldMeant::kPast:
      late_.push_back(command);
      break;
    case WorldMeant::kOver:
      break;
  }
}

/// Handles `end`: another node has given up waiting for a process that takes a region over. This node ends only if it
/// waits, too.
void NodeProcess::hear_of_end(const messages::RunCommand& end) {
  const bool waits = phase_ == NodePhase::kRecovering || phase_ == NodePhase::kSpare;
  if (!waits || !can_be_meant(end)) return;
  break_off(fmt::format("nobody takes over region {}, whose node has died", core::value_of(end.region)));
}

Worlds NodeProcess::known_worlds() const {
  Worlds known;
  known.begun = begun_;
  if (phase_ == NodePhase::kWaiting) known.waits_for = generation_;
  if (restore_) known.restored = restore_->generation;
  if (reset_) known.reset_to = reset_->generation + 1;
  return known;
}

void NodeProcess::obey(const messages::RunCommand& command) {
  using Kind = messages::RunCommandKind;
  switch (command.kind) {
    case Kind::kStart:
    case Kind::kLost:
    case Kind::kRestore:
    case Kind::kDrain:
    case Kind::kTake:
    case Kind::kEnd:
      break;
    case Kind::kPause:
      hold_in(command.at_step);
      hurry_until_ = std::max(hurry_until_, command.at_step);
      break;
    case Kind::kStep:
      if (!hold_at_) break;
      step_on(command);
      if (*hold_at_ > node_->current_step()) setpoints_.await(command, Clock::now());
      break;
    case Kind::kResume:
      if (hold_at_) pacer_.set_epoch(*hold_at_ + 1, command.epoch_ns, command.clock_ahead, node::read_clocks());
      hold_at_.reset();
      break;
    case Kind::kReset:
      reset_ = command;
      hurry_until_ = std::max(hurry_until_, command.at_step);
      break;
    case Kind::kStop:
      stops_standing_ = phase_ == NodePhase::kRecovering;
      stop_at_ = std::min(stop_at_.value_or(command.at_step), command.at_step);
      hurry_until_ = std::max(hurry_until_, command.at_step);
      break;
    case Kind::kRate:
      pacer_.set_rate(command.rate, command.at_step, command.epoch_ns, command.clock_ahead, node::read_clocks());
      status_.content().rate = command.rate;
      break;
  }
}

void NodeProcess::hold_in(core::Step state) {
  hold_at_ = state;
  asked_steps_.begin(state);
}

/// Executes a step command in a paused run. States of earlier step commands keep their pace.
void NodeProcess::step_on(const messages::RunCommand& step) {
  const core::Step next = *hold_at_ + 1;
  node::Pacer later = pacer_;
  later.set_epoch(next, step.epoch_ns, step.clock_ahead, node::read_clocks());
  if (later.due(next) > pacer_.due(next)) pacer_ = later;
  asked_steps_.add(step);
  hold_at_ = std::max(*hold_at_, asked_steps_.end());
}

/// Executes the commands for this world that came before it began here. The start of the world would have undone them.
void NodeProcess::obey_early_commands() {
  begun_ = generation_;
  for (const messages::RunCommand& command : std::exchange(early_, {})) execute(command);
}

/// Handles commands for the world that all have left. Some nodes may have executed them and some not, so the node that
/// sent the restore sends them once more, and all execute those.
void NodeProcess::obey_late_commands() {
  for (messages::RunCommand command : std::exchange(late_, {})) {
    if (restore_->region != options_.region) continue;
    command.generation = generation_;
    command.request = 0;
    command.request = control().send(command);
    execute(command);
  }
}

bool NodeProcess::can_be_meant(const messages::RunCommand& command) {
  const std::string why = run_control_limits_.problem_with(
      command, std::max({generation_, restoring_, status_.content().era}), node::wall_clock_ns());
  if (!why.empty()) control().refuse(command, why);
  return why.empty();
}

bool NodeProcess::reset_if_due() {
  if (!reset_ || node_->current_step() < reset_->at_step) return false;
  const messages::RunCommand reset = *reset_;
  const bool stands = hold_at_.has_value();
  reset_.reset();
  enter(NodeEvent::kReset);
  begin_generation(reset.generation + 1, reset);
  if (stands) hold_in(node_->current_step());
  status_.make_due();  // the client waits for this status
  return true;
}

/// True if the state of a change has been computed and is not confirmed yet. An order given now would not reach all
/// nodes before they stop for the change.
bool NodeProcess::is_about_to_change() const {
  return std::ranges::any_of(run_orders_, [this](const core::Order& order) {
    return core::changes_the_run(order.action) && node_->current_step() >= order.at_step;
  });
}

/// Serves clients' commands. The lead, the live node of the lowest region, gives orders their state.
void NodeProcess::serve_clients() {
  if (is_about_to_change()) return;
  const auto& statuses = control().statuses();
  const auto is_ours = [this](const messages::SeenStatus& seen) {
    return seen.status.agreement == status_.content().agreement;
  };
  RunView run;
  run.leads = true;
  for (const auto& [region, seen] : statuses) {
    if (!is_ours(seen)) continue;
    run.facts.complete = run.facts.complete && seen.is_live();
    if (!seen.is_live()) continue;
    run.facts.bodies += seen.status.bodies;
    run.leads = run.leads && region >= options_.region;
  }
  run.lacking = [&statuses, is_ours](std::uint64_t mesh) {
    std::vector<core::RegionId> lacking;
    for (const auto& [region, seen] : statuses) {
      const std::vector<std::uint64_t>& known = seen.status.meshes;
      const bool has_it = std::find(known.begin(), known.end(), mesh) != known.end();
      if (is_ours(seen) && seen.is_live() && !has_it) lacking.push_back(region);
    }
    return lacking;
  };
  run.holds_at = hold_at_;
  endpoints_.commands().serve(*node_, run);
  saving_.save_as_it_stands(*node_, endpoints_.commands());
  if (run.leads) {
    saving_.save_regularly(*node_, first_step());
    compute_until_change();
    step_back(run);
  }
  status_.content().meshes = endpoints_.commands().meshes();
  if (const std::optional<double> rate = endpoints_.commands().take_wanted_rate()) change_rate(*rate);
}

/// Sends all nodes another rate as a run command, because steps may be seconds apart. The next step stays due when it
/// was, and the new rate holds from it on.
void NodeProcess::change_rate(double rate) {
  const double steps = std::min(pacer_.rate(), 1.0) * kRateNoticeS / launch_.step_s();
  messages::RunCommand command;
  command.kind = messages::RunCommandKind::kRate;
  command.generation = generation_;
  command.at_step = node_->current_step() + 1 + static_cast<core::Step>(steps);
  command.epoch_ns = node::wall_clock_ns() + static_cast<std::int64_t>(1e9 * kRateNoticeS);
  command.rate = rate;
  command.request = control().send(command);
  execute(command);
}

/// Makes a paused run compute up to a change. A change needs its state to be confirmed, so all nodes compute up to it,
/// and pause again in the first state of the new world.
void NodeProcess::compute_until_change() {
  const std::optional<core::Step> change = endpoints_.commands().change_at();
  if (!change || !hold_at_ || node_->current_step() < *hold_at_) return;
  const core::Step until_certain = node_->current_step() - node_->confirmed_step();
  messages::RunCommand command;
  command.kind = messages::RunCommandKind::kStep;
  command.generation = generation_;
  command.run = options_.run;
  command.count = std::max<core::Step>(1, *change + until_certain - *hold_at_);
  command.at_step = *hold_at_ + command.count;
  command.epoch_ns = node::wall_clock_ns() + static_cast<std::int64_t>(1e9 * kRateNoticeS);
  command.request = control().send(command);
  execute(command);
}

}  // namespace aurasim::process
