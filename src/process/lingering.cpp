#include "process/lingering.h"

#include <algorithm>
#include <utility>

#include "process/long_step.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kLinger = 1500ms;
constexpr auto kPatienceWithRunners = 30s;  ///< since any node was last seen to go on

}  // namespace

bool all_have_left(const SeenNodes& nodes, core::RegionId self, const std::vector<core::RegionId>& silent) {
  return std::ranges::all_of(nodes, [&](const auto& entry) {
    const auto& [region, seen] = entry;
    const bool is_silent = seen.lost || std::ranges::find(silent, region) != silent.end();
    return region == self || seen.has_ended() || (is_silent && !seen.dead);
  });
}

bool Lingering::stays(const SeenNodes& nodes, bool is_complete, bool is_stopped, Clock::time_point now) {
  if (is_complete) return false;
  return now < begin_ + kLinger || (others_run(nodes, now) && !is_stopped);
}

bool Lingering::others_run(const SeenNodes& nodes, Clock::time_point now) {
  bool running = false;
  for (const auto& [region, seen] : nodes) {
    if (region == self_ || !seen.is_live()) continue;
    running = true;
    const bool has_moved = std::exchange(steps_[region], seen.status.step) != seen.status.step;
    if (has_moved || long_step(seen, now)) moved_ = now;
  }
  return running && now < moved_ + kPatienceWithRunners;
}

}  // namespace aurasim::process
