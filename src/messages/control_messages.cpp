#include "messages/control_messages.h"

#include <array>
#include <cstddef>

namespace aurasim::messages {

const char* name_of(NodeState state) {
  static constexpr std::array kNames = {"starting", "waiting",    "running", "paused", "finished",
                                        "failed",   "recovering", "spare",   "cut off"};
  return kNames.at(static_cast<std::size_t>(state));
}

const char* name_of(ExchangeInUse exchange) {
  static constexpr std::array kNames = {"not chosen", "aura", "coupled"};
  return kNames.at(static_cast<std::size_t>(exchange));
}

const char* name_of(RunCommandKind kind) {
  static constexpr std::array kNames = {"start", "pause", "resume",  "step",  "reset", "stop",
                                        "rate",  "lost",  "restore", "drain", "take",  "end"};
  return kNames.at(static_cast<std::size_t>(kind));
}

}  // namespace aurasim::messages
