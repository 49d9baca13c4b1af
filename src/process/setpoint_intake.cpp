#include "process/setpoint_intake.h"

#include <utility>

#include <spdlog/spdlog.h>

namespace aurasim::process {
namespace {

/// Limit of the messages kept in a pause. Those beyond it are given to the node at once.
constexpr std::size_t kMostKept = 4096;

}  // namespace

void SetpointIntake::take(std::span<const core::Setpoints> received, std::uint64_t endpoints_refused, core::Step step,
                          std::optional<core::Step> holds_at, const Give& give) {
  const auto take_one = [&](const core::Setpoints& setpoints) {
    const bool waits = holds_at && !setpoints.statics.empty() && setpoints.at_step > *holds_at;
    if (waits && kept_.size() < kMostKept) {
      kept_.push_back(setpoints);
    } else {
      give_to_node(setpoints, step, give);
    }
  };
  for (const core::Setpoints& setpoints : std::exchange(kept_, {})) take_one(setpoints);
  for (const core::Setpoints& setpoints : received) take_one(setpoints);
  counts_.refused = endpoints_refused + not_taken_ + unbearable_;
  if (counts_.refused > 0 && !std::exchange(refused_logged_, true)) {
    spdlog::warn(
        "setpoints were refused: they cannot be decoded, are too many or too far ahead, or make a body too fast. The "
        "status counts refused setpoints");
  }
}

void SetpointIntake::give_to_node(const core::Setpoints& setpoints, core::Step step, const Give& give) {
  ++counts_.received;
  switch (give(setpoints, awaited_.name({setpoints.client, setpoints.sequence}))) {
    case core::Heard::kInTime:
      break;
    case core::Heard::kLate:
      ++counts_.late;
      if (!std::exchange(late_logged_, true)) {
        spdlog::warn(
            "setpoints for state {} were received in state {}, which is too late: send them for a later state. The "
            "status counts late setpoints",
            setpoints.at_step, step);
      }
      break;
    case core::Heard::kRefused:
      ++not_taken_;
      break;
  }
}

bool SetpointIntake::has_all_awaited(const AwaitedWords::HasReceived& has_received, core::Step next,
                                     Clock::time_point now) {
  const bool all_received = awaited_.are_here(has_received, now);
  for (const core::ProgramWord& word : awaited_.take_given_up()) {
    ++not_taken_;
    spdlog::warn(
        "a step command names setpoints {} of program {:x}, which were not received: state {} is computed without them",
        word.number, word.program, next);
  }
  return all_received;
}

}  // namespace aurasim::process
