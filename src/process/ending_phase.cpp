#include "process/ending_phase.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "host/stop_signal.h"
#include "process/lingering.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceWithReaders = 1s;  // some readers may have left without notice

}  // namespace

command_line::ExitCode EndingPhase::end() {
  const double factor = run_.real_time_factor();
  const bool fenced = run_.fence.closed(), comes_to_its_end = !fenced && !run_.restoration.is_broken_off();
  if (fenced) spdlog::error("{}", run_.fence.reason());
  if (!comes_to_its_end || run_.phase != NodePhase::kLingering) {
    run_.enter(comes_to_its_end ? NodeEvent::kLast : NodeEvent::kFence);
  }
  run_.publish(fenced ? run_.fence.reason() : run_.restoration.why_broken_off());
  run_.endpoints.observers().while_paused(*run_.node);
  // Taken first: a node that leaves from now on has finished, and has not died.
  const std::vector<core::RegionId> dead = run_.node->protocol().intake().dead_regions();
  if (comes_to_its_end) linger();
  const core::Step last =
      comes_to_its_end && run_.has_reached_the_end() ? *run_.schedule.stop_at() : run_.node->current_step();
  run_.record(run_.node->finish(last));
  if (run_.records.recorder() != nullptr && comes_to_its_end && !run_.node->settled())
    run_.records.write_settling(run_.node->settle());
  const dds::TransportCounters& sent = run_.transport().counters();
  const std::uint64_t bytes = sent.aura.sent_bytes + sent.migration.sent_bytes;
  const char* const outcome = fenced ? "fenced" : comes_to_its_end ? "finished" : "broken off";
  const messages::Status& status = run_.status.content();
  run_.records.finish(*run_.node,
                      {factor, outcome, dead, bytes, run_.checkpoints().sent_bytes(), run_.checkpoints().left_out(),
                       messages::name_of(status.exchange), status.round_trip_ms, run_.records.exchanges()});
  run_.conclude_saves();
  if (fenced) return command_line::ExitCode::kFenced;
  if (!comes_to_its_end) return command_line::ExitCode::kBrokenOff;
  run_.enter(NodeEvent::kSettled);
  if (run_.notices.broken_bodies() > 0) return command_line::ExitCode::kBroken;
  return run_.saving.regular_ones_failed() ? command_line::ExitCode::kNotSaved : command_line::ExitCode::kOk;
}

command_line::ExitCode EndingPhase::end_without_world() {
  run_.enter(NodeEvent::kFence);
  run_.publish(run_.restoration.why_broken_off());
  return command_line::ExitCode::kBrokenOff;
}

/// Waits after the last state until the others have left (lingering.h), and until all readers know the last status.
void EndingPhase::linger() {
  Lingering lingering(run_.options.region, Clock::now());
  const auto is_complete = [this] {
    return run_.node->ready_to_settle() && others_have_left() && has_all_of_the_last_states();
  };
  while (lingering.stays(run_.control().statuses(), is_complete(), host::stop_requested(), Clock::now())) {
    executor_.execute_commands();
    if (run_.recovers() && !others_have_left() && !run_.restoration.stop_asked()) run_.look_for_deaths();
    run_.publish();
    run_.control().wait(10ms);
  }
  const auto last_word = Clock::now();
  while (!run_.control().status_is_known() && Clock::now() < last_word + kPatienceWithReaders)
    run_.control().wait(10ms);
}

/// True if all other nodes have left or died.
bool EndingPhase::others_have_left() {
  return all_have_left(run_.control().statuses(), run_.options.region, run_.node->protocol().intake().dead_regions());
}

/// True if all messages of the nodes that have ended have arrived, also of later states than this node's: bodies may be
/// on their way from there.
bool EndingPhase::has_all_of_the_last_states() {
  return std::ranges::all_of(run_.control().statuses(), [this](const auto& entry) {
    const auto& [region, seen] = entry;
    return !seen.has_ended() || run_.node->protocol().intake().has_all(region, seen.status.step);
  });
}

}  // namespace aurasim::process
