#include "process/command_queue.h"

namespace aurasim::process {

bool CommandQueue::is_for_now(const messages::RunCommand& command, Worlds known) {
  known.begun = begun_;
  switch (world_meant(command.generation, known)) {
    case WorldMeant::kPresent:
      return true;
    case WorldMeant::kNext:
      early_.push_back(command);
      return false;
    case WorldMeant::kPast:
      late_.push_back(command);
      return false;
    case WorldMeant::kOver:
      return false;
  }
  return false;
}

std::vector<messages::RunCommand> CommandQueue::take_early(core::Generation generation) {
  begun_ = generation;
  return std::exchange(early_, {});
}

}  // namespace aurasim::process
