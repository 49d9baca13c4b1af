// The status that a node publishes some times a second.
#include <algorithm>

#include <spdlog/spdlog.h>

#include "process/node_runtime.h"
#include "setup/guard_log.h"

namespace aurasim::process {

void NodeRuntime::publish_running() {
  if (const auto now = Clock::now(); !status.period_is_over(now) && !status.is_awaited(awaited_of_status(), now))
    return;
  status.note_node(*node);
  status.content().real_time_factor = real_time_factor();
  notices.note_clock(node::read_clocks(), node->current_step());
  notices.note_records(records.end());
  publish(notices.text());
}

Awaited NodeRuntime::awaited_of_status() const {
  const bool waits = phase == NodePhase::kRecovering || phase == NodePhase::kSpare;
  return {waits ? restoration.waits_in() : generation, schedule.holds_at(),
          phase == NodePhase::kPaused ? node->current_step() : 0};
}

void NodeRuntime::publish(const std::string& text) {
  const auto now = Clock::now();
  const bool is_cut_off = phase == NodePhase::kRecovering && fence.is_cut_off();
  const messages::NodeState state = is_cut_off ? messages::NodeState::kCutOff : state_of(phase).value();
  const Awaited awaited = awaited_of_status();
  if (!status.is_due(state, now) && !status.is_awaited(awaited, now)) return;
  status.note_published(state, awaited, now);
  note_strangers();
  messages::Status& content = status.content();
  content.holds_at = awaited.holds_at;
  content.generation = awaited.generation;
  content.rate = schedule.rate();
  content.text = text;
  content.step = node ? node->current_step() : 0;
  // In a pause, later states are computed only on the way to a redo. Nobody else sees them.
  if (node && schedule.holds_at() && node->is_going_back()) content.step = std::min(content.step, *schedule.holds_at());
  if (endpoints.has_checkpoints()) content.parts = checkpoints().parts();
  if (recovers() && node) recovery.note_kept(control().statuses(), content.era);
  content.setpoints_heard = setpoints.counts().received;
  content.setpoints_late = setpoints.counts().late;
  content.setpoints_refused = setpoints.counts().refused;
  content.saved = saving.ledger().saved();
  content.not_saved = saving.ledger().not_saved();
  control().publish_status(content);
  setup::log_new_refusals(endpoints.participant());
}

/// Logs refused messages of processes that are no neighbours. They mark no node dead; each kind is logged once and
/// counted.
void NodeRuntime::note_strangers() {
  for (const std::string& text : endpoints.participant().take_said()) {
    spdlog::warn("region {}: {}", core::value_of(options.region), text);
  }
  status.note_refused_strangers(endpoints.participant().refused_of_strangers());
}

double NodeRuntime::real_time_factor() const {
  return schedule.real_time_factor(node->current_step() - first_step(), Clock::now());
}

}  // namespace aurasim::process
