#include "process/meeting.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "node/pacer.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kNoticeOfStart = 500ms;  ///< time in which all nodes receive the start command

std::string ahead_or_behind(std::chrono::nanoseconds ahead) {
  return fmt::format("{:.1f} s {}", std::chrono::duration<double>(std::chrono::abs(ahead)).count(),
                     ahead > 0ns ? "ahead of" : "behind");
}

}  // namespace

std::string refusal_of_maps(const std::map<std::uint64_t, messages::WorldMap>& maps, const OwnRun& own) {
  for (const auto& [version, map] : maps) {
    if (map.agreement == own.agreement && map.from_step == own.first_step) continue;
    if (map.agreement == own.agreement) {
      return fmt::format(
          "DDS domain {} already has this run, and it begins with state {}; this one with state {}. Give "
          "all nodes the same saved world (--load), or use another dds.domain.",
          own.domain, map.from_step, own.first_step);
    }
    return fmt::format(
        "DDS domain {} already has a run that does not agree with this one: scene '{}', {} regions, map {:016x}, "
        "agreement {:016x}; this is scene '{}', {} regions, map {:016x}, agreement {:016x}. Use another dds.domain.",
        own.domain, map.scene, map.regions.size(), map.map_version, map.agreement, own.scene, own.regions,
        own.map_version, own.agreement);
  }
  return {};
}

std::string refusal_of_strangers(const std::vector<messages::SeenStatus>& strangers, const OwnRun& own,
                                 bool has_published) {
  for (const messages::SeenStatus& stranger : strangers) {
    const messages::Status& other = stranger.status;
    const bool is_meeting =
        other.state == messages::NodeState::kStarting || other.state == messages::NodeState::kWaiting;
    if (other.agreement != own.agreement) continue;  // refusal_of_maps() gives the better message
    if (has_published && is_meeting && other.run > own.run) continue;
    return fmt::format("region {} already has a node in DDS domain {}: process {}, step {}. Use another dds.domain.",
                       core::value_of(other.region), own.domain, other.pid, other.step);
  }
  return {};
}

double share_of_nodes(const SeenNodes& nodes, core::RegionId self, std::size_t regions) {
  std::size_t there = nodes.contains(self) ? 0 : 1;
  for (const auto& [region, seen] : nodes) there += seen.is_live();
  return static_cast<double>(there) / static_cast<double>(regions);
}

std::uint64_t progress_of_meeting(const SeenNodes& nodes, std::uint64_t endpoints_found) {
  std::uint64_t progress = endpoints_found;
  for (const auto& [region, seen] : nodes) {
    progress += seen.is_live() && seen.status.state == messages::NodeState::kWaiting ? 2 : 1;
  }
  return progress;
}

std::string who_does_not_wait(const SeenNodes& nodes, std::size_t regions) {
  std::vector<std::uint32_t> absent, busy;
  for (std::uint32_t r = 0; r < regions; ++r) {
    const auto seen = nodes.find(core::RegionId{r});
    if (seen == nodes.end()) {
      absent.push_back(r);
    } else if (seen->second.status.state != messages::NodeState::kWaiting) {
      busy.push_back(r);
    }
  }
  return fmt::format("regions that have not reported: [{}]; regions that still look for their neighbours: [{}]",
                     fmt::join(absent, ", "), fmt::join(busy, ", "));
}

std::vector<std::string> wrong_clocks(const SeenNodes& nodes, bool is_one_host) {
  std::vector<std::string> texts;
  for (const auto& [region, seen] : nodes) {
    const bool is_late = !is_one_host && seen.clock_ahead <= -node::kClockTolerance;
    if (!is_late && seen.clock_ahead < node::kClockTolerance) continue;
    texts.push_back(
        fmt::format("the wall clock of region {}'s host is {} this one's: steps are counted from when the start came",
                    core::value_of(region), ahead_or_behind(seen.clock_ahead)));
  }
  return texts;
}

messages::RunCommand with_clock_of(const SeenNodes& nodes, core::RegionId sender, messages::RunCommand command) {
  const auto seen = nodes.find(sender);
  if (seen == nodes.end()) return command;
  command.clock_ahead = std::max(command.clock_ahead, seen->second.clock_ahead);
  return command;
}

std::optional<messages::RunCommand> AwaitedStart::to_send(const SeenNodes& nodes, std::uint64_t run,
                                                          std::int64_t wall_ns) const {
  if (region_ != core::RegionId{0} || start_) return std::nullopt;
  std::size_t waiting = 0;
  for (const auto& [region, seen] : nodes) {
    waiting += !seen.lost && seen.status.state == messages::NodeState::kWaiting &&
               seen.status.generation == generation_ && region != region_;
  }
  if (waiting + 1 < regions_) return std::nullopt;
  messages::RunCommand start;
  start.kind = messages::RunCommandKind::kStart;
  start.generation = generation_;
  start.run = run;
  start.epoch_ns = wall_ns + std::chrono::nanoseconds(kNoticeOfStart).count();
  return start;
}

std::vector<std::string> EarlyDeaths::look(const SeenNodes& nodes) {
  std::vector<std::string> texts;
  for (const auto& [region, seen] : nodes) {
    if (seen.is_live() || seen.status.state == messages::NodeState::kFinished) {
      named_.erase(region);
    } else if (named_.insert(region).second) {
      texts.push_back(fmt::format("the node of region {} (process {}) {} before the run has begun",
                                  core::value_of(region), seen.status.pid, seen.lost ? "has died" : "has given up"));
    }
  }
  return texts;
}

}  // namespace aurasim::process
