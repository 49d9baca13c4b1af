#include "process/node_process.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "host/stop_signal.h"
#include "process/long_step.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

}  // namespace

NodeProcess::NodeProcess(config::Launch launch, const NodeOptions& options)
    : run_(std::move(launch), options),
      succession_(run_),
      executor_(run_, succession_),
      clients_(run_, executor_),
      meeting_(run_, executor_),
      changing_(run_, executor_),
      recovering_(run_, executor_, succession_),
      ending_(run_, executor_) {}

command_line::ExitCode NodeProcess::run() {
  try {
    const command_line::ExitCode code = meet_and_run();
    run_.endpoints.flush();
    return code;
  } catch (const std::exception& error) {
    if (run_.phase != NodePhase::kListening) {
      run_.phase = NodePhase::kRefused;
      run_.publish(error.what());
    }
    throw;
  }
}

command_line::ExitCode NodeProcess::meet_and_run() {
  if (run_.options.takes_over) return take_over();
  if (!meeting_.domain_is_free()) return not_begun();
  run_.enter(NodeEvent::kFree);
  run_.publish_map(run_.generation, run_.first_step());
  run_.publish();
  if (!meeting_.agree_on_exchange()) return not_begun();
  run_.endpoints.open(run_.transport_settings());
  if (!meeting_.meet_neighbours() || !meeting_.wait_for_start()) return not_begun();
  for (const std::string& text : wrong_clocks(run_.control().statuses(), run_.endpoints.stays_on_this_host())) {
    spdlog::warn("{}", text);
  }
  run_.begin_generation(run_.start.start()->generation, *run_.start.start());
  return run_steps();
}

bool NodeProcess::comes_back_as_spare() const {
  return run_.fence.closed() && !run_.options.has_launcher &&
         run_.launch.survival.on_death == config::OnDeath::kRecover;
}

/// Takes over the region of a dead node. The other nodes wait in a recovery.
command_line::ExitCode NodeProcess::take_over() {
  run_.endpoints.open_checkpoints();
  recovering_.recover("takes the region over");
  if (run_.fence.closed()) {
    run_.refuse(run_.fence.reason());
    return command_line::ExitCode::kRefused;
  }
  if (!run_.node && run_.restoration.is_broken_off()) return ending_.end_without_world();
  return run_.node ? run_steps() : not_begun();
}

command_line::ExitCode NodeProcess::not_begun() {
  if (run_.phase == NodePhase::kRefused) return command_line::ExitCode::kRefused;
  const bool is_known = run_.phase != NodePhase::kListening;
  run_.enter(NodeEvent::kLast);
  if (is_known) run_.publish();
  return command_line::ExitCode::kOk;
}

command_line::ExitCode NodeProcess::run_steps() {
  for (;;) {
    try {
      run_until_end();
      if (!run_.recovers()) look_for_death_at_the_end();
      const bool leaves = succession_.leaves_now() || (run_.leaving.has_begun() && succession_.can_leave_to_others());
      return leaves && !run_.restoration.is_broken_off() ? succession_.leave_to_successor() : ending_.end();
    } catch (const SomebodyDied& died) {
      if (run_.recovers()) {
        recovering_.recover(died.what());
      } else {
        run_.break_off(died.what());
      }
      if (!run_.node && run_.restoration.is_broken_off()) return ending_.end_without_world();
    }
  }
}

/// A run that ends by a death is broken off on all nodes. The launcher of a node may ask it to end before it has looked
/// for deaths: a coupled node notices nothing while it waits in the middle of a state.
void NodeProcess::look_for_death_at_the_end() {
  if (run_.fence.closed() || run_.has_reached_the_end()) return;
  if (const auto why = run_.death()) run_.break_off(*why);
}

void NodeProcess::run_until_end() {
  while (!is_over()) {
    executor_.execute_early_commands();
    executor_.execute_commands();
    run_.look_for_deaths();
    executor_.execute_late_commands();
    clients_.serve_clients();
    run_.keep_parts();
    if (executor_.reset_if_due() || changing_.change_if_due()) continue;
    run_.endpoints.publish_ros2(*run_.node, run_.generation);
    take_setpoints();
    if (!wait_until_due()) continue;  // true: the step is due without waiting
    run_.look_for_deaths();
    compute_step();
    run_.saving.plan_checkpoint(*run_.node);
  }
}

bool NodeProcess::is_over() {
  succession_.leave_if_asked();
  return finished() || succession_.leaves_now();
}

bool NodeProcess::finished() {
  return succession_.leaves_in_vain() || host::stop_requested() || run_.restoration.stop_asked() ||
         run_.has_reached_the_end() || run_.fence.closed() || run_.restoration.is_broken_off();
}

/// True when the next state is due, allowed and everything it needs is here. Returns often, so that commands are
/// received.
bool NodeProcess::wait_until_due() {
  const core::Step next = run_.node->current_step() + 1;
  const auto begin = Clock::now();
  if (run_.schedule.holds_at()) run_.schedule.follow(farthest_pause(run_.control().statuses(), run_.generation), begin);
  // A run that is paused computes on until a redo that is ordered, which takes it back to the state of the pause.
  if (run_.schedule.is_held_in(run_.node->current_step()) && !run_.node->is_going_back()) {
    wait_in_pause();
    run_.schedule.note_pause(Clock::now() - begin);
    return false;
  }
  if (run_.phase == NodePhase::kPaused) run_.enter(NodeEvent::kGoesOn);
  if (!has_awaited_setpoints()) {
    run_.control().wait(20ms);
    return false;
  }
  if (const std::chrono::nanoseconds until = run_.schedule.time_until(next, node::read_clocks()); until > 0ns) {
    run_.transport().wait_for_arrival(std::min<std::chrono::nanoseconds>(until, 20ms));
    run_.node->ready();
    run_.publish_running();
    return false;
  }
  const bool complete = run_.node->ready();
  run_.status.content().refused = run_.transport().refused();
  run_.notices.note_refusals(run_.node->protocol().intake().refusals());
  if (run_.fence_is_open() && complete) return true;
  run_.transport().wait_for_arrival(20ms);
  run_.records.note_wait(milliseconds(Clock::now() - begin));
  note_waiting();
  run_.publish_running();
  return false;
}

/// Waits a moment in the state in which the run is paused.
void NodeProcess::wait_in_pause() {
  if (run_.phase != NodePhase::kPaused) run_.enter(NodeEvent::kHeld);
  run_.publish();
  const bool is_checked = run_.node->stand();
  run_.endpoints.observers().while_paused(*run_.node);
  // Observers wait until all nodes have checked the state, and for the states of bodies that are under way to this
  // node.
  if (is_checked && run_.node->has_all_until(run_.node->current_step())) {
    run_.control().wait(20ms);
  } else {
    run_.transport().wait_for_arrival(2ms);
  }
  run_.fence_is_open();
}

void NodeProcess::compute_step() {
  const auto is_gone = [](const auto& entry) { return entry.second.lost && entry.second.has_ended(); };
  if (std::ranges::any_of(run_.control().statuses(), is_gone)) run_.node->give_up_redo();
  const auto begin = Clock::now();
  keep_the_end();
  try {
    run_.node->step();
  } catch (const core::SeamsBroken& broken) {
    spdlog::warn("state {} is not computed: {}", run_.node->current_step() + 1, broken.what());
    run_.notices.note_news(broken.what());
    return;
  }
  const node::StepReport& report = run_.node->report();
  run_.control().note_state();
  run_.endpoints.programs().note_state();
  if (report.put_back_from) return note_redo(report);
  run_.saving.look_at_doubtful(*run_.node, std::nullopt);
  run_.endpoints.commands().after_step(report);  // before the observers, which need the additions
  run_.endpoints.observers().after_step(*run_.node, report);
  run_.changes.add(report.orders);
  for (const core::Order& order : report.orders) {
    if (std::holds_alternative<core::Save>(order.action)) run_.saving.expect(order);
  }
  const double waited_ms = 1e3 * report.durations.gathering_s;
  const double frame_ms = milliseconds(Clock::now() - begin) - waited_ms;
  run_.records.note_wait(waited_ms);
  run_.node->protocol().report_frame(report.step, frame_ms / 1e3);
  run_.records.note_frame(report.step, frame_ms);
  run_.record(run_.node->confirmed());
  const auto now = Clock::now();
  run_.schedule.note_computed(now);
  run_.command_queue.note(report.step, now);
  run_.notices.note_computed();
  run_.status.note_step(report, frame_ms, now);
  run_.note_exchanges(now);
  run_.publish_running();
  changing_.take_reached_changes();
}

/// Notes a redo. Observers have no state that is computed again with another result.
void NodeProcess::note_redo(const node::StepReport& report) {
  const core::TogetherPair first = report.put_back_for.empty() ? core::TogetherPair{} : report.put_back_for.front();
  const std::string news = fmt::format(
      "put back from state {} to {} (redo {}): bodies {} and {}{} have touched on two nodes", *report.put_back_from,
      report.step, run_.node->redos(), core::value_of(first.a), core::value_of(first.b),
      report.put_back_for.size() > 1 ? fmt::format(" and {} more pairs", report.put_back_for.size() - 1)
                                     : std::string());
  spdlog::info("region {} {}", core::value_of(run_.options.region), news);
  run_.notices.note_news(news);
  // A redo for a pair gives the states that all nodes have checked the same bits again.
  if (report.put_back_for_static) run_.saving.look_at_doubtful(*run_.node, report.step);
  run_.note_messages_of_saves();
  run_.status.content().redos = run_.node->redos();
  run_.endpoints.put_back(report.step, report.put_back_confirmed);
  run_.record(run_.node->confirmed());
  run_.schedule.note_computed(Clock::now());
  run_.publish_running();
}

/// Gives the setpoints that have come to the node; they take effect in the next state. To be called before each state,
/// and often in between. Every node receives all setpoints.
void NodeProcess::take_setpoints() {
  run_.setpoints.take(
      run_.endpoints.take_setpoints(run_.generation), run_.endpoints.refused_setpoints(), run_.node->current_step(),
      run_.schedule.holds_at(),
      [this](const core::Setpoints& setpoints, bool known_to_all) { return run_.node->hear(setpoints, known_to_all); });
}

/// True if all setpoints that step commands name have been received. No node computes the state before.
bool NodeProcess::has_awaited_setpoints() {
  return run_.setpoints.has_all_awaited(
      [this](const core::ProgramWord& word) { return run_.endpoints.programs().has_received(word); },
      run_.node->current_step() + 1, Clock::now());
}

/// Logs the regions that this node waits for, if it has waited long.
void NodeProcess::note_waiting() {
  const auto now = Clock::now();
  if (!run_.notices.waits_for_long(now)) return;
  const core::Step next = run_.node->current_step() + 1;
  std::vector<MissingRegion> missing;
  for (const core::RegionId region : run_.node->protocol().missing(next)) {
    const auto other = run_.control().statuses().find(region);
    const bool is_known = other != run_.control().statuses().end();
    missing.push_back(
        {region, is_known ? long_step(other->second, now) : std::nullopt, run_.status.refused_of(region)});
  }
  run_.notices.note_missing(next, missing, now);
}

/// Keeps the next state in which the run ends or changes, if it is known.
void NodeProcess::keep_the_end() {
  if (run_.schedule.stop_at()) run_.node->keep(*run_.schedule.stop_at());
  for (const core::Step step : run_.changes.states_to_keep()) run_.node->keep(step);
}

}  // namespace aurasim::process
