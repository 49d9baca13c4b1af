#include "cli/target_list.h"

#include <algorithm>

#include <fmt/format.h>

namespace aurasim::cli {

void print(const std::vector<experiment::Target>& targets) {
  for (const experiment::Target& t : targets) {
    fmt::print("{:<6} {:>10.4g}  {} {:.4g}  {}\n", t.met() ? "met" : "MISSED", t.found,
               t.at_least ? "at least" : "at most ", t.allowed, t.name);
  }
}

bool all_met(const std::vector<experiment::Target>& targets) {
  return std::all_of(targets.begin(), targets.end(), [](const auto& t) { return t.met(); });
}

}  // namespace aurasim::cli
