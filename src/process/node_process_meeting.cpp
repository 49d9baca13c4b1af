// How the nodes of a run find each other, check that no other run is in the domain, and begin together.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "host/long_work.h"
#include "host/stop_signal.h"
#include "process/node_process.h"
#include "setup/silence.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kListenFirst = 500ms;  // announcements come every 50 ms at first

std::string ahead_or_behind(std::chrono::nanoseconds ahead) {
  return fmt::format("{:.1f} s {}", std::chrono::duration<double>(std::chrono::abs(ahead)).count(),
                     ahead > 0ns ? "ahead of" : "behind");
}

/// Progress messages while nodes are awaited. Only the node of region 0 logs them, for all.
host::LongWork waiting_for_nodes(std::size_t regions) {
  return {fmt::format("waiting for the nodes of {} regions to be there", regions),
          [](const std::string& text) { spdlog::info("{}", text); }};
}

}  // namespace

/// True if another run is in the domain. Two runs would mix their worlds' messages.
bool NodeProcess::another_run_is_here() { return another_agreement_is_here() || the_same_run_is_here(); }

/// True if a map in the domain has another agreement (map, scene or settings) or begins with another state. Refuses to
/// run then.
bool NodeProcess::another_agreement_is_here() {
  for (const auto& [version, map] : control().maps()) {
    if (map.agreement == status_.content().agreement && map.from_step == first_step()) continue;
    if (map.agreement == status_.content().agreement) {
      refuse(
          fmt::format("DDS domain {} already has this run, and it begins with state {}; this one with state {}. Give "
                      "all nodes the same saved world (--load), or use another dds.domain.",
                      launch_.dds.domain, map.from_step, first_step()));
      return true;
    }
    refuse(fmt::format(
        "DDS domain {} already has a run that does not agree with this one: scene '{}', {} regions, map {:016x}, "
        "agreement {:016x}; this is scene '{}', {} regions, map {:016x}, agreement {:016x}. Use another dds.domain.",
        launch_.dds.domain, map.scene, map.regions.size(), map.map_version, map.agreement, launch_.scene.name,
        launch_.regions.size(), status_.content().map_version, status_.content().agreement));
    return true;
  }
  return false;
}

/// True if the same launch runs twice by mistake; refuses to run then. Of two that begin together, the one with the
/// lower number stays.
bool NodeProcess::the_same_run_is_here() {
  for (const messages::SeenStatus& stranger : control().strangers()) {
    const messages::Status& other = stranger.status;
    const bool is_meeting =
        other.state == messages::NodeState::kStarting || other.state == messages::NodeState::kWaiting;
    if (other.agreement != status_.content().agreement)
      continue;  // another_agreement_is_here() gives the better message
    if (endpoints_.has_transport() && is_meeting && other.run > options_.run) continue;
    refuse(fmt::format("region {} already has a node in DDS domain {}: process {}, step {}. Use another dds.domain.",
                       core::value_of(other.region), launch_.dds.domain, other.pid, other.step));
    return true;
  }
  return false;
}

/// Listens before it publishes: a node's endpoints would disturb a run that is already here.
bool NodeProcess::domain_is_free() {
  const auto begin = Clock::now();
  // A node with a status has published a map, too, which may still be on its way.
  while (Clock::now() < begin + (control().strangers().empty() ? kListenFirst : 6 * kListenFirst)) {
    if (host::stop_requested() || another_run_is_here()) return false;
    control().wait(20ms);
  }
  return true;
}

bool NodeProcess::hears_another_node() {
  return std::ranges::any_of(control().statuses(),
                             [this](const auto& entry) { return entry.first != options_.region; });
}

/// Share of the nodes that are there, this one included; 0 to 1.
double NodeProcess::share_of_nodes() {
  std::size_t there = control().statuses().contains(options_.region) ? 0 : 1;
  for (const auto& [region, seen] : control().statuses()) there += seen.is_live();
  return static_cast<double>(there) / static_cast<double>(launch_.regions.size());
}

bool NodeProcess::meet_neighbours() {
  const auto began = Clock::now();
  Patience patience(options_.start_time_out, began);
  setup::SilenceWord silence(launch_, endpoints_.participant());
  host::LongWork waiting = waiting_for_nodes(launch_.regions.size());
  while (!transport().all_matched()) {
    if (host::stop_requested() || another_run_is_here()) return false;
    name_the_dead();
    silence.look(hears_another_node());
    if (options_.region == core::RegionId{0}) waiting.reached(share_of_nodes());
    patience.look(met(), Clock::now());
    if (patience.is_over(Clock::now())) {
      try {
        transport().wait_until_matched(0ns);
      } catch (const dds::NeighboursMissing& missing) {
        const bool is_alone = !hears_another_node();
        refuse(fmt::format("after {} s, {} of them with nothing new: {}{}", whole_seconds(Clock::now() - began),
                           whole_seconds(patience.waited(Clock::now())), missing.what(),
                           is_alone ? setup::word_about_keys(endpoints_.participant().peers_by_keys(), launch_) : ""));
        return false;
      }
    }
    control().wait(50ms);
  }
  if (another_run_is_here()) return false;
  enter(NodeEvent::kMet);
  return true;
}

/// Measure of how far all nodes have met, as far as this node knows. It only grows with progress.
std::uint64_t NodeProcess::met() {
  std::uint64_t met = transport().found();
  for (const auto& [region, seen] : control().statuses()) {
    met += seen.is_live() && seen.status.state == messages::NodeState::kWaiting ? 2 : 1;
  }
  return met;
}

/// The node of region 0 starts the run once every region waits for it.
void NodeProcess::start_when_all_wait() {
  if (options_.region != core::RegionId{0} || start_) return;
  std::size_t waiting = 0;
  for (const auto& [region, seen] : control().statuses()) {
    waiting += !seen.lost && seen.status.state == messages::NodeState::kWaiting &&
               seen.status.generation == waits_to_start_ && region != options_.region;
  }
  if (waiting + 1 < launch_.regions.size()) return;
  messages::RunCommand start;
  start.kind = messages::RunCommandKind::kStart;
  start.generation = waits_to_start_;
  start.run = options_.run;
  start.epoch_ns = node::wall_clock_ns() + 500'000'000;
  start.request = control().send(start);
  start_ = start;
}

/// Message for users: the nodes that do not wait for the start yet, and why.
std::string NodeProcess::who_does_not_wait() {
  std::vector<std::uint32_t> absent, busy;
  for (std::uint32_t r = 0; r < launch_.regions.size(); ++r) {
    const auto seen = control().statuses().find(core::RegionId{r});
    if (seen == control().statuses().end()) {
      absent.push_back(r);
    } else if (seen->second.status.state != messages::NodeState::kWaiting) {
      busy.push_back(r);
    }
  }
  return fmt::format("regions that have not reported: [{}]; that still look for their neighbours: [{}]",
                     fmt::join(absent, ", "), fmt::join(busy, ", "));
}

bool NodeProcess::wait_for_start() {
  publish();
  const auto began = Clock::now();
  Patience patience(options_.start_time_out, began);
  host::LongWork waiting = waiting_for_nodes(launch_.regions.size());
  while (!start_) {
    if (host::stop_requested() || another_run_is_here()) return false;
    patience.look(met(), Clock::now());
    if (patience.is_over(Clock::now())) {
      refuse(fmt::format("the run has not started in {} s, and for {} s there was nothing new; {}",
                         whole_seconds(Clock::now() - began), whole_seconds(patience.waited(Clock::now())),
                         who_does_not_wait()));
      return false;
    }
    name_the_dead();
    publish();
    start_when_all_wait();
    if (options_.region == core::RegionId{0}) waiting.reached(share_of_nodes());
    execute_commands();
    control().wait(50ms);
  }
  enter(NodeEvent::kStarted);
  return true;
}

/// Makes endpoints for the generation that waits to start. They match only endpoints of the same generation, and not
/// those of dead processes or those that others are about to drop, where messages would be lost. `wait` returns soon,
/// or throws.
void NodeProcess::connect_anew(dds::TransportSettings settings, const std::function<void(const char*)>& wait) {
  settings.life = life_ = waits_to_start_;
  endpoints_.connect(settings);
  while (!transport().all_matched()) wait("its neighbours");
  generation_ = waits_to_start_;
  start_.reset();
  enter(NodeEvent::kStands);
  while (!start_) {
    start_when_all_wait();
    if (!start_) wait("the others");
  }
  enter(NodeEvent::kStarted);
}

/// Logs nodes that have died while all wait for each other. A user may start them again; a launcher ends the run. A
/// node that has finished a short run does not count, even if its message that the run begins is still on its way.
void NodeProcess::name_the_dead() {
  for (const auto& [region, seen] : control().statuses()) {
    if (seen.is_live() || seen.status.state == messages::NodeState::kFinished) {
      missed_.erase(region);
    } else if (missed_.insert(region).second) {
      spdlog::warn("the node of region {} (process {}) {} before the run has begun", core::value_of(region),
                   seen.status.pid, seen.lost ? "has died" : "has given up");
    }
  }
}

/// The command with the clock difference to its sender, from the fastest of the last statuses. A single message may
/// have been long on its way, which looks like a clock that is behind.
messages::RunCommand NodeProcess::with_clock_of(core::RegionId region, messages::RunCommand command) {
  const auto sender = control().statuses().find(region);
  if (sender == control().statuses().end()) return command;
  command.clock_ahead = std::max(command.clock_ahead, sender->second.clock_ahead);
  return command;
}

/// Logs hosts whose clocks are wrong; the run does not depend on them. On one host a clock that looks behind is not
/// logged: its statuses were only slow, because many processes start at once.
void NodeProcess::compare_clocks() {
  const bool is_one_host = endpoints_.stays_on_this_host();
  for (const auto& [region, seen] : control().statuses()) {
    const bool is_late = !is_one_host && seen.clock_ahead <= -node::kClockTolerance;
    if (!is_late && seen.clock_ahead < node::kClockTolerance) continue;
    spdlog::warn("the wall clock of region {}'s host is {} this one's: steps are counted from when the start came",
                 core::value_of(region), ahead_or_behind(seen.clock_ahead));
  }
}

}  // namespace aurasim::process
