// How a node comes to the end of its run, and leaves so that the others can come to theirs.
#include <algorithm>
#include <map>
#include <utility>

#include <spdlog/spdlog.h>

#include "cli/long_step.h"
#include "cli/node_process.h"
#include "cli/stop_signal.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kLinger = 1500ms;
constexpr auto kPatienceWithRunners = 30s;  // since any of them was seen to go on
constexpr auto kPatienceWithReaders = 1s;   // some may have left without a word

}  // namespace

bool NodeProcess::finished() {
  if (leaves_by_ && (!can_leave_to_others() || Clock::now() > *leaves_by_)) return true;
  return stop_requested() || stops_standing_ || (stop_at_ && has_reached(*stop_at_)) || fence_.closed() ||
         !broken_off_.empty();
}

/// The state is there, and nothing can come to question it.
bool NodeProcess::has_reached(core::Step step) const {
  return node_ && node_->current_step() >= step && node_->confirmed_step() >= step;
}

/// The next state in which the run ends or changes, as far as it is known.
void NodeProcess::keep_the_end() {
  if (stop_at_) node_->keep(*stop_at_);
  for (const core::Order& order : run_orders_) {
    if (core::changes_the_run(order.action)) node_->keep(order.at_step);
  }
}

ExitCode NodeProcess::end() {
  const double factor = real_time_factor();
  const bool fenced = fence_.closed(), comes_to_its_end = !fenced && broken_off_.empty();
  if (fenced) spdlog::error("{}", fence_.reason());
  if (!comes_to_its_end || phase_ != NodePhase::kLingering) {
    enter(comes_to_its_end ? NodeEvent::kLast : NodeEvent::kFence);
  }
  publish(fenced ? fence_.reason() : broken_off_);
  observers_->while_paused(*node_);
  // Whoever leaves from now on has finished, too: that is no death.
  const std::vector<core::RegionId> dead = node_->protocol().intake().dead_regions();
  if (comes_to_its_end) linger();
  const core::Step last = stop_at_ && comes_to_its_end && has_reached(*stop_at_) ? *stop_at_ : node_->current_step();
  record(node_->finish(last));
  if (recorder_ && comes_to_its_end && !node_->settled()) recorder_->write_settling(node_->settle());
  const dds::TransportCounters& sent = transport_->counters();
  const std::uint64_t bytes = sent.aura.sent_bytes + sent.migration.sent_bytes + sent.migration_ack.sent_bytes;
  if (recorder_) {
    const char* const outcome = fenced ? "fenced" : comes_to_its_end ? "finished" : "broken off";
    recorder_->finish(*node_, {factor, outcome, dead, bytes, checkpoints_->sent_bytes(), checkpoints_->left_out()});
  }
  conclude_saves();
  if (fenced) return ExitCode::kFenced;
  if (!comes_to_its_end) return ExitCode::kBrokenOff;
  enter(NodeEvent::kSettled);
  if (broken_bodies_ > 0) return ExitCode::kBroken;
  return saves_.regular_ones_failed() ? ExitCode::kNotSaved : ExitCode::kOk;
}

/// Ends a process of a run that has broken off, which has no world yet.
ExitCode NodeProcess::end_without_world() {
  enter(NodeEvent::kFence);
  publish(broken_off_);
  return ExitCode::kBrokenOff;
}

/// The others may still need what was published last, and we their acknowledgements. Where nodes do not wait for each
/// other, one may come to the last state long before the rest: if it left, they would take it for dead.
void NodeProcess::linger() {
  const auto begin = Clock::now();
  std::map<core::RegionId, core::Step> steps;
  auto moved = begin;
  const auto others_run = [&] {
    bool running = false;
    for (const auto& [region, seen] : control_.statuses()) {
      if (region == options_.region || !seen.is_live()) continue;
      running = true;
      const bool has_moved = std::exchange(steps[region], seen.status.step) != seen.status.step;
      if (has_moved || long_step(seen, Clock::now())) moved = Clock::now();
    }
    return running && !stop_requested() && Clock::now() < moved + kPatienceWithRunners;
  };
  while (!(node_->ready_to_settle() && all_have_left() && has_all_of_the_last_states()) &&
         (Clock::now() < begin + kLinger || others_run())) {
    execute_commands();
    if (recovers() && !all_have_left() && !stops_standing_) look_for_deaths();
    publish();
    control_.wait(10ms);
  }
  const auto last_word = Clock::now();
  while (!control_.status_is_known() && Clock::now() < last_word + kPatienceWithReaders) control_.wait(10ms);
}

/// Of those who have ended in a later state than this node, too: bodies may be on their way from there.
bool NodeProcess::has_all_of_the_last_states() {
  return std::ranges::all_of(control_.statuses(), [this](const auto& entry) {
    const auto& [region, seen] = entry;
    return !seen.has_ended() || node_->protocol().intake().has_all(region, seen.status.step);
  });
}

/// Or have died, as far as anybody can tell: of whoever has come to the end the last word may be lost.
bool NodeProcess::all_have_left() {
  const std::vector<core::RegionId> silent = node_->protocol().intake().dead_regions();
  return std::ranges::all_of(control_.statuses(), [&](const auto& entry) {
    const auto& [region, seen] = entry;
    const bool is_silent = seen.lost || std::ranges::find(silent, region) != silent.end();
    return region == options_.region || seen.has_ended() || (is_silent && !seen.dead);
  });
}

}  // namespace aurasim::cli
