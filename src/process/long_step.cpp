#include "process/long_step.h"

#include <algorithm>

#include <fmt/format.h>

#include "process/patience.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongStep = 2s;  // statuses come at least once a second
constexpr auto kLogAfter = 10s;

/// How long the node has computed its step: the time since its last status, which it published before the step.
std::optional<std::chrono::steady_clock::duration> computes_for(const messages::SeenStatus& seen,
                                                                std::chrono::steady_clock::time_point now) {
  const bool computes = !seen.lost && seen.status.state == messages::NodeState::kRunning;
  if (!computes || now < seen.seen + kLongStep) return std::nullopt;
  return now - seen.seen;
}

}  // namespace

std::optional<std::string> long_step(const messages::SeenStatus& seen, std::chrono::steady_clock::time_point now) {
  const auto time = computes_for(seen, now);
  if (!time) return std::nullopt;
  return fmt::format("computes one step for {} s", whole_seconds(*time));
}

bool computes_for_long(const std::map<core::RegionId, messages::SeenStatus>& nodes, core::RegionId self,
                       std::chrono::steady_clock::time_point now) {
  return std::ranges::any_of(
      nodes, [&](const auto& entry) { return entry.first != self && long_step(entry.second, now).has_value(); });
}

std::optional<std::string> LongSteps::news(const messages::SeenStatus& seen, Clock::time_point now) {
  const auto time = computes_for(seen, now);
  const auto logged = logged_.find(seen.status.region);
  if (!time) {
    if (logged != logged_.end()) logged_.erase(logged);
    return std::nullopt;
  }
  const Clock::duration next = logged == logged_.end() ? Clock::duration(kLogAfter) : 2 * logged->second;
  if (*time < next) return std::nullopt;
  logged_[seen.status.region] = *time;
  return fmt::format("the node of region {} (process {}) computes one step for {} s, after state {}",
                     core::value_of(seen.status.region), seen.status.pid, whole_seconds(*time), seen.status.step);
}

}  // namespace aurasim::process
