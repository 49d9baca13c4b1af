// How a node receives setpoints of programs that steer bodies and joints (topic control).
#include <algorithm>
#include <iterator>

#include <spdlog/spdlog.h>

#include "process/node_process.h"

namespace aurasim::process {

/// Takes in the setpoints that have come; they take effect in the next state. To be called before each state, and often
/// in between. Every node receives all setpoints.
void NodeProcess::hear_programs() {
  std::vector<core::Setpoints> heard = programs_->take(generation_);
  if (ros2_) std::ranges::move(ros2_->take(generation_), std::back_inserter(heard));
  for (const core::Setpoints& said : heard) {
    switch (node_->hear(said)) {
      case core::Heard::kInTime:
        break;
      case core::Heard::kLate:
        ++status_.setpoints_late;
        if (!std::exchange(says_late_, true)) {
          spdlog::warn("setpoints for state {} have come in state {}; how many are late is counted", said.at_step,
                       node_->current_step());
        }
        break;
      case core::Heard::kRefused:
        ++unheard_setpoints_;
        break;
    }
    ++status_.setpoints_heard;
  }
  status_.setpoints_refused =
      programs_->refused() + (ros2_ ? ros2_->refused() : 0) + unheard_setpoints_ + unbearable_setpoints_;
  if (status_.setpoints_refused > 0 && !std::exchange(says_refused_, true)) {
    spdlog::warn("setpoints were refused: not understood, too many, too far ahead, or more than a body can bear");
  }
}

/// True if all setpoints that step commands name have been received. No node computes the state before.
bool NodeProcess::has_heard_what_steps_name() {
  const bool all_heard = awaited_words_.are_here(
      [this](const core::ProgramWord& word) { return programs_->has_heard(word); }, std::chrono::steady_clock::now());
  for (const core::ProgramWord& word : awaited_words_.take_given_up()) {
    ++unheard_setpoints_;
    spdlog::warn("a step names setpoints {} of program {:x}, which have not come: state {} is computed without them",
                 word.number, word.program, node_->current_step() + 1);
  }
  return all_heard;
}

}  // namespace aurasim::process
