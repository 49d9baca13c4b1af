// The status that a node publishes some times a second.
#include <spdlog/spdlog.h>

#include "process/node_process.h"
#include "setup/guard_log.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

/// Publishes the status of a running node, if its period is over.
void NodeProcess::publish_running() {
  if (!status_.period_is_over(Clock::now())) return;
  status_.note_node(*node_);
  status_.content().real_time_factor = real_time_factor();
  notices_.note_clock(node::read_clocks(), node_->current_step());
  notices_.note_records(records_.end());
  publish(notices_.text());
}

/// Publishes the status with this text, if it is due.
void NodeProcess::publish(const std::string& text) {
  const auto now = Clock::now();
  const bool is_cut_off = phase_ == NodePhase::kRecovering && fence_.is_cut_off();
  const messages::NodeState state = is_cut_off ? messages::NodeState::kCutOff : state_of(phase_).value();
  if (!status_.is_due(state, now)) return;
  status_.note_published(state, now);
  note_strangers();
  messages::Status& status = status_.content();
  status.holds_at = schedule_.holds_at();
  status.rate = schedule_.rate();
  status.text = text;
  const bool stands = phase_ == NodePhase::kRecovering || phase_ == NodePhase::kSpare;
  status.generation = stands ? restoration_.stands_in() : generation_;
  status.step = node_ ? node_->current_step() : 0;
  if (endpoints_.has_checkpoints()) status.parts = checkpoints().parts();
  if (recovers() && node_) recovery_.note_kept(control().statuses(), status.era);
  status.setpoints_heard = setpoints_.counts().received;
  status.setpoints_late = setpoints_.counts().late;
  status.setpoints_refused = setpoints_.counts().refused;
  status.saved = saving_.ledger().saved();
  status.not_saved = saving_.ledger().not_saved();
  control().publish_status(status);
  setup::log_new_refusals(endpoints_.participant());
}

/// Logs refused messages of processes that are no neighbours. They mark no node dead; each kind is logged once and
/// counted.
void NodeProcess::note_strangers() {
  for (const std::string& text : endpoints_.participant().take_said()) {
    spdlog::warn("region {}: {}", core::value_of(options_.region), text);
  }
  status_.note_refused_strangers(endpoints_.participant().refused_of_strangers());
}

/// Simulated seconds per second since the world began, pauses left out.
double NodeProcess::real_time_factor() const {
  return schedule_.real_time_factor(node_->current_step() - first_step(), Clock::now());
}

}  // namespace aurasim::process
