// How a node ends its run, and leaves so that the other nodes can end theirs.
#include <algorithm>
#include <map>
#include <utility>

#include <spdlog/spdlog.h>

#include "host/stop_signal.h"
#include "process/long_step.h"
#include "process/node_process.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kLinger = 1500ms;
constexpr auto kPatienceWithRunners = 30s;  // since any node was last seen to go on
constexpr auto kPatienceWithReaders = 1s;   // some readers may have left without notice

}  // namespace

bool NodeProcess::finished() {
  if (leaves_by_ && (!can_leave_to_others() || Clock::now() > *leaves_by_)) return true;
  return host::stop_requested() || stops_standing_ || (stop_at_ && has_reached(*stop_at_)) || fence_.closed() ||
         !broken_off_.empty();
}

/// True if the state has been computed and is confirmed.
bool NodeProcess::has_reached(core::Step step) const {
  return node_ && node_->current_step() >= step && node_->confirmed_step() >= step;
}

/// Keeps the next state in which the run ends or changes, if it is known.
void NodeProcess::keep_the_end() {
  if (stop_at_) node_->keep(*stop_at_);
  for (const core::Order& order : run_orders_) {
    if (core::changes_the_run(order.action)) node_->keep(order.at_step);
  }
}

command_line::ExitCode NodeProcess::end() {
  const double factor = real_time_factor();
  const bool fenced = fence_.closed(), comes_to_its_end = !fenced && broken_off_.empty();
  if (fenced) spdlog::error("{}", fence_.reason());
  if (!comes_to_its_end || phase_ != NodePhase::kLingering) {
    enter(comes_to_its_end ? NodeEvent::kLast : NodeEvent::kFence);
  }
  publish(fenced ? fence_.reason() : broken_off_);
  endpoints_.observers().while_paused(*node_);
  // Taken first: a node that leaves from now on has finished, and has not died.
  const std::vector<core::RegionId> dead = node_->protocol().intake().dead_regions();
  if (comes_to_its_end) linger();
  const core::Step last = stop_at_ && comes_to_its_end && has_reached(*stop_at_) ? *stop_at_ : node_->current_step();
  record(node_->finish(last));
  if (records_.recorder() != nullptr && comes_to_its_end && !node_->settled()) records_.write_settling(node_->settle());
  const dds::TransportCounters& sent = transport().counters();
  const std::uint64_t bytes = sent.aura.sent_bytes + sent.migration.sent_bytes + sent.migration_ack.sent_bytes;
  const char* const outcome = fenced ? "fenced" : comes_to_its_end ? "finished" : "broken off";
  records_.finish(*node_, {factor, outcome, dead, bytes, checkpoints().sent_bytes(), checkpoints().left_out()});
  conclude_saves();
  if (fenced) return command_line::ExitCode::kFenced;
  if (!comes_to_its_end) return command_line::ExitCode::kBrokenOff;
  enter(NodeEvent::kSettled);
  if (notices_.broken_bodies() > 0) return command_line::ExitCode::kBroken;
  return saving_.regular_ones_failed() ? command_line::ExitCode::kNotSaved : command_line::ExitCode::kOk;
}

/// Ends a process of a run that has broken off, which has no world yet.
command_line::ExitCode NodeProcess::end_without_world() {
  enter(NodeEvent::kFence);
  publish(broken_off_);
  return command_line::ExitCode::kBrokenOff;
}

/// Waits after the last state. The others may still need this node's last messages, and this node their
/// acknowledgements. In a free-running run one node may come to the last state long before the rest; if it left, they
/// would take it for dead.
void NodeProcess::linger() {
  const auto begin = Clock::now();
  std::map<core::RegionId, core::Step> steps;
  auto moved = begin;
  const auto others_run = [&] {
    bool running = false;
    for (const auto& [region, seen] : control().statuses()) {
      if (region == options_.region || !seen.is_live()) continue;
      running = true;
      const bool has_moved = std::exchange(steps[region], seen.status.step) != seen.status.step;
      if (has_moved || long_step(seen, Clock::now())) moved = Clock::now();
    }
    return running && !host::stop_requested() && Clock::now() < moved + kPatienceWithRunners;
  };
  while (!(node_->ready_to_settle() && all_have_left() && has_all_of_the_last_states()) &&
         (Clock::now() < begin + kLinger || others_run())) {
    execute_commands();
    if (recovers() && !all_have_left() && !stops_standing_) look_for_deaths();
    publish();
    control().wait(10ms);
  }
  const auto last_word = Clock::now();
  while (!control().status_is_known() && Clock::now() < last_word + kPatienceWithReaders) control().wait(10ms);
}

/// True if all messages of the nodes that have ended have arrived, also of later states than this node's: bodies may be
/// on their way from there.
bool NodeProcess::has_all_of_the_last_states() {
  return std::ranges::all_of(control().statuses(), [this](const auto& entry) {
    const auto& [region, seen] = entry;
    return !seen.has_ended() || node_->protocol().intake().has_all(region, seen.status.step);
  });
}

/// True if all other nodes have left or died. The last status of a node that has ended may be lost, so silence counts
/// as well.
bool NodeProcess::all_have_left() {
  const std::vector<core::RegionId> silent = node_->protocol().intake().dead_regions();
  return std::ranges::all_of(control().statuses(), [&](const auto& entry) {
    const auto& [region, seen] = entry;
    const bool is_silent = seen.lost || std::ranges::find(silent, region) != silent.end();
    return region == options_.region || seen.has_ended() || (is_silent && !seen.dead);
  });
}

}  // namespace aurasim::process
