#include "overseer/commands.h"

#include <array>

namespace aurasim::overseer {

const char* name_of(const Command& command) {
  static constexpr std::array kNames = {"pause",  "resume", "reset",   "step",     "rate", "scene", "regions", "spawn",
                                        "static", "remove", "impulse", "velocity", "ray",  "save",  "load",    "back"};
  static_assert(std::variant_size_v<Command> == kNames.size());
  return kNames.at(command.index());
}

bool changes_the_world(const Command& command) { return !std::holds_alternative<CastRay>(command); }

}  // namespace aurasim::overseer
