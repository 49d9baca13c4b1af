#include "launch/closing_line.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::launch {

std::string closing_line(const std::map<core::RegionId, messages::SeenStatus>& statuses, std::size_t regions,
                         bool has_begun, double step_s) {
  if (!has_begun) return "the run has not begun\n";
  std::uint64_t bodies = 0, hand_offs = 0, late = 0, missed = 0;
  std::map<std::string, std::uint64_t> violations;
  core::Step step = 0;
  std::vector<std::uint32_t> unknown;
  for (std::uint32_t r = 0; r < regions; ++r) {
    const auto seen = statuses.find(core::RegionId{r});
    if (seen == statuses.end() || seen->second.status.state != messages::NodeState::kFinished) {
      unknown.push_back(r);
      continue;
    }
    const messages::Status& status = seen->second.status;
    step = std::max(step, status.step);
    bodies += status.bodies;
    hand_offs += status.hand_offs_out;
    late += status.late_collisions;
    missed += status.missed_collisions;
    for (const auto& [kind, count] : status.violations.by_kind()) violations[kind] += count;
  }
  if (unknown.size() == regions) {
    return fmt::format(
        "the run has broken off: no node has published that it came to its end. --report DIR keeps the records of each "
        "node\n");
  }
  const std::string lacking =
      unknown.empty() ? ""
                      : fmt::format("; without regions [{}], whose bodies are not known", fmt::join(unknown, ", "));
  return fmt::format("ended with state {}, {:.2f} s: {} bodies, {} hand-offs, {} late and {} missed collisions{}{}\n",
                     step, static_cast<double>(step) * step_s, bodies, hand_offs, late, missed,
                     words_of_broken_promises(violations), lacking);
}

std::string words_of_broken_promises(const std::map<std::string, std::uint64_t>& by_kind) {
  std::vector<std::string> words;
  for (const auto& [kind, count] : by_kind) {
    if (count > 0) words.push_back(fmt::format("{} {}", kind, count));
  }
  return words.empty() ? "" : fmt::format("; broken promises: {}", fmt::join(words, ", "));
}

}  // namespace aurasim::launch
