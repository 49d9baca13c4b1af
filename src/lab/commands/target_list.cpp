#include "lab/commands/target_list.h"

#include <algorithm>

#include <fmt/format.h>

namespace aurasim::lab::commands {

void print(const std::vector<lab::Target>& targets) {
  for (const lab::Target& t : targets) {
    fmt::print("{:<6} {:>10.4g}  {} {:.4g}  {}\n", t.met() ? "met" : "MISSED", t.found,
               t.at_least ? "at least" : "at most ", t.allowed, t.name);
  }
}

bool all_met(const std::vector<lab::Target>& targets) {
  return std::all_of(targets.begin(), targets.end(), [](const auto& t) { return t.met(); });
}

}  // namespace aurasim::lab::commands
