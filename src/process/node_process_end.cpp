// How a node ends its run, and leaves so that the other nodes can end theirs.
#include <algorithm>

#include <spdlog/spdlog.h>

#include "host/stop_signal.h"
#include "process/lingering.h"
#include "process/node_process.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceWithReaders = 1s;  // some readers may have left without notice

}  // namespace

bool NodeProcess::finished() {
  if (leaving_.has_begun() && (!can_leave_to_others() || leaving_.is_overdue(Clock::now()))) return true;
  return host::stop_requested() || restoration_.stop_asked() || has_reached_the_end() || fence_.closed() ||
         restoration_.is_broken_off();
}

/// True if the last state of the run is known, computed and confirmed.
bool NodeProcess::has_reached_the_end() const { return schedule_.stop_at() && has_reached(*schedule_.stop_at()); }

/// True if the state has been computed and is confirmed.
bool NodeProcess::has_reached(core::Step step) const {
  return node_ && node_->current_step() >= step && node_->confirmed_step() >= step;
}

/// Keeps the next state in which the run ends or changes, if it is known.
void NodeProcess::keep_the_end() {
  if (schedule_.stop_at()) node_->keep(*schedule_.stop_at());
  for (const core::Step step : changes_.states_to_keep()) node_->keep(step);
}

command_line::ExitCode NodeProcess::end() {
  const double factor = real_time_factor();
  const bool fenced = fence_.closed(), comes_to_its_end = !fenced && !restoration_.is_broken_off();
  if (fenced) spdlog::error("{}", fence_.reason());
  if (!comes_to_its_end || phase_ != NodePhase::kLingering) {
    enter(comes_to_its_end ? NodeEvent::kLast : NodeEvent::kFence);
  }
  publish(fenced ? fence_.reason() : restoration_.why_broken_off());
  endpoints_.observers().while_paused(*node_);
  // Taken first: a node that leaves from now on has finished, and has not died.
  const std::vector<core::RegionId> dead = node_->protocol().intake().dead_regions();
  if (comes_to_its_end) linger();
  const core::Step last = comes_to_its_end && has_reached_the_end() ? *schedule_.stop_at() : node_->current_step();
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
  publish(restoration_.why_broken_off());
  return command_line::ExitCode::kBrokenOff;
}

/// Waits after the last state until the others have left (lingering.h), and until all readers know the last status.
void NodeProcess::linger() {
  Lingering lingering(options_.region, Clock::now());
  const auto is_complete = [this] {
    return node_->ready_to_settle() && others_have_left() && has_all_of_the_last_states();
  };
  while (lingering.stays(control().statuses(), is_complete(), host::stop_requested(), Clock::now())) {
    execute_commands();
    if (recovers() && !others_have_left() && !restoration_.stop_asked()) look_for_deaths();
    publish();
    control().wait(10ms);
  }
  const auto last_word = Clock::now();
  while (!control().status_is_known() && Clock::now() < last_word + kPatienceWithReaders) control().wait(10ms);
}

/// True if all other nodes have left or died.
bool NodeProcess::others_have_left() {
  return all_have_left(control().statuses(), options_.region, node_->protocol().intake().dead_regions());
}

/// True if all messages of the nodes that have ended have arrived, also of later states than this node's: bodies may be
/// on their way from there.
bool NodeProcess::has_all_of_the_last_states() {
  return std::ranges::all_of(control().statuses(), [this](const auto& entry) {
    const auto& [region, seen] = entry;
    return !seen.has_ended() || node_->protocol().intake().has_all(region, seen.status.step);
  });
}

}  // namespace aurasim::process
