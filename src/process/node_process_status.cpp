// The status that a node publishes some times a second.
#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "process/node_process.h"
#include "records/durations.h"
#include "setup/guard_log.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kStatusPeriod = 100ms;

messages::Durations summary_of(std::vector<double>& values) {
  return {records::percentile(values, 0.5), records::percentile(values, 0.99), records::percentile(values, 1)};
}

}  // namespace

void NodeProcess::note(const node::StepReport& report, double frame_ms) {
  if (Clock::now() - window_.begin > 1s) window_ = {};
  window_.frame.push_back(frame_ms);
  window_.physics.push_back(1e3 * report.durations.physics_s);
  window_.protocol.push_back(1e3 * report.durations.protocol_s);
  window_.transport.push_back(1e3 * report.durations.transport_s);
  status_.bodies = report.bodies;
  status_.awake = report.awake;
  status_.foreign_auras = report.foreign_auras;
  status_.largest_cluster = report.largest_cluster;
  status_.hand_offs_out += report.departures.size();
  status_.hand_offs_in += report.arrivals.size();
}

void NodeProcess::publish_running() {
  if (Clock::now() - last_published_ < kStatusPeriod) return;
  const core::ViolationLog& log = node_->protocol().violations();
  status_.violations = {log.count(core::ViolationKind::kSpeed), log.count(core::ViolationKind::kLatency),
                        log.count(core::ViolationKind::kFrame), log.count(core::ViolationKind::kPromise),
                        log.count(core::ViolationKind::kSpan)};
  status_.late_collisions = node_->collision_watch().late();
  status_.missed_collisions = node_->collision_watch().missed();
  status_.frame = summary_of(window_.frame);
  status_.physics = summary_of(window_.physics);
  status_.protocol = summary_of(window_.protocol);
  status_.transport = summary_of(window_.transport);
  status_.real_time_factor = real_time_factor();
  status_.dead = node_->protocol().intake().dead_regions();
  const std::span<const core::Listened> listens_to = node_->protocol().listens_to();
  status_.listens_to.assign(listens_to.begin(), listens_to.end());
  watch_the_clock();
  watch_the_records();
  publish(!waiting_.empty() ? waiting_ : !fault_.empty() ? fault_ : notice_);
}

void NodeProcess::publish(const std::string& text) {
  const auto now = Clock::now();
  const bool is_cut_off = phase_ == NodePhase::kRecovering && fence_.is_cut_off();
  const messages::NodeState state = is_cut_off ? messages::NodeState::kCutOff : state_of(phase_).value();
  if (state == status_.state && now - last_published_ < kStatusPeriod) return;
  last_published_ = now;
  note_strangers();
  status_.state = state;
  status_.holds_at = hold_at_;
  status_.text = text;
  const bool stands = phase_ == NodePhase::kRecovering || phase_ == NodePhase::kSpare;
  status_.generation = stands ? stands_in_ : generation_;
  status_.step = node_ ? node_->current_step() : 0;
  if (checkpoints_) status_.parts = checkpoints_->parts();
  if (recovers() && node_) recovery_.note_kept(control_.statuses(), status_.era);
  status_.saved = saving_.ledger().saved();
  status_.not_saved = saving_.ledger().not_saved();
  control_.publish_status(status_);
  setup::log_new_refusals(*participant_);
}

double NodeProcess::real_time_factor() const {
  const double wall_s = std::chrono::duration<double>(Clock::now() - began_ - paused_).count();
  return wall_s > 0 ? static_cast<double>(node_->current_step() - first_step()) * launch_.step_s() / wall_s : 1;
}

void NodeProcess::watch_the_clock() {
  const std::chrono::nanoseconds jump = clock_watch_.look(node::read_clocks());
  if (jump == 0ns) return;
  notice_ = fmt::format("this host's wall clock was set {:.1f} s {} at step {}: the pace is kept without it",
                        std::chrono::duration<double>(std::chrono::abs(jump)).count(), jump > 0ns ? "forward" : "back",
                        node_->current_step());
  spdlog::warn("{}", notice_);
}

/// Logs once that the records have ended. A full disk ends the records, not the run.
void NodeProcess::watch_the_records() {
  if (!recorder_ || !recorder_->records_end() || says_records_end_) return;
  says_records_end_ = true;
  const records::RecordsEnd& end = *recorder_->records_end();
  notice_ = fmt::format("nothing is recorded after step {}: {}", end.after, end.why);
  spdlog::error("{}", notice_);
}

}  // namespace aurasim::process
