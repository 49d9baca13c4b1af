// How the nodes of a run find each other, check that no other run is in the domain, and begin together. The decisions
// are in meeting.h.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "host/long_work.h"
#include "host/stop_signal.h"
#include "process/node_process.h"
#include "process/patience.h"
#include "setup/silence.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kListenFirst = 500ms;  // announcements come every 50 ms at first

/// Progress messages while nodes are awaited. Only the node of region 0 logs them, for all.
host::LongWork waiting_for_nodes(std::size_t regions) {
  return {fmt::format("waiting for the nodes of {} regions to be there", regions),
          [](const std::string& text) { spdlog::info("{}", text); }};
}

}  // namespace

/// True if another run is in the domain. Refuses to run then.
bool NodeProcess::another_run_is_here() {
  const messages::Status& self = status_.content();
  const OwnRun own = {options_.region, options_.run,       self.agreement,     self.map_version,
                      first_step(),    launch_.dds.domain, launch_.scene.name, launch_.regions.size()};
  std::string why = refusal_of_maps(control().maps(), own);
  if (why.empty()) why = refusal_of_strangers(control().strangers(), own, endpoints_.has_transport());
  if (why.empty()) return false;
  refuse(why);
  return true;
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

bool NodeProcess::meet_neighbours() {
  const auto began = Clock::now();
  Patience patience(options_.start_time_out, began);
  setup::SilenceWord silence(launch_, endpoints_.participant());
  host::LongWork waiting = waiting_for_nodes(launch_.regions.size());
  while (!transport().all_matched()) {
    if (host::stop_requested() || another_run_is_here()) return false;
    log_early_deaths();
    silence.look(hears_another_node());
    note_meeting(patience, waiting);
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

/// Waits for the command that starts the run. Region 0 sends it once every region waits for it.
bool NodeProcess::wait_for_start() {
  publish();
  const auto began = Clock::now();
  Patience patience(options_.start_time_out, began);
  host::LongWork waiting = waiting_for_nodes(launch_.regions.size());
  while (!start_.start()) {
    if (host::stop_requested() || another_run_is_here()) return false;
    note_meeting(patience, waiting);
    if (patience.is_over(Clock::now())) {
      refuse(fmt::format("the run has not started in {} s, and for {} s there was nothing new; {}",
                         whole_seconds(Clock::now() - began), whole_seconds(patience.waited(Clock::now())),
                         who_does_not_wait(control().statuses(), launch_.regions.size())));
      return false;
    }
    log_early_deaths();
    publish();
    start_when_all_wait();
    execute_commands();
    control().wait(50ms);
  }
  enter(NodeEvent::kStarted);
  return true;
}

/// Notes how far all have met.
void NodeProcess::note_meeting(Patience& patience, host::LongWork& waiting) {
  const SeenNodes& nodes = control().statuses();
  patience.look(progress_of_meeting(nodes, transport().found()), Clock::now());
  if (options_.region != core::RegionId{0}) return;
  waiting.reached(share_of_nodes(nodes, options_.region, launch_.regions.size()));
}

void NodeProcess::log_early_deaths() {
  for (const std::string& text : early_deaths_.look(control().statuses())) spdlog::warn("{}", text);
}

void NodeProcess::start_when_all_wait() {
  auto start = start_.to_send(control().statuses(), options_.run, node::wall_clock_ns());
  if (!start) return;
  start->request = control().send(*start);
  start_.accept(*start);
}

/// Makes endpoints for the awaited generation. They match only endpoints of the same generation, and not those of dead
/// processes or those that others are about to drop, where messages would be lost.
void NodeProcess::begin_to_connect(dds::TransportSettings settings) {
  settings.life = life_ = start_.generation();
  endpoints_.connect(settings);
}

/// Goes on after begin_to_connect(). Returns what the node waits for; null once the awaited generation has started.
const char* NodeProcess::go_on_connecting() {
  if (generation_ != start_.generation()) {
    if (!transport().all_matched()) return "its neighbours";
    generation_ = start_.generation();
    start_.forget();
    enter(NodeEvent::kStands);
  }
  start_when_all_wait();
  if (!start_.start()) return "the others";
  enter(NodeEvent::kStarted);
  return nullptr;
}

}  // namespace aurasim::process
