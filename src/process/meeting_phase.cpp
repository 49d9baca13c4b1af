#include "process/meeting_phase.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "host/stop_signal.h"
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

/// Waits until what others say reaches this node. Refuses to run if there is no way.
bool MeetingPhase::finds_hub() {
  const auto began = Clock::now();
  Patience patience(run_.options.start_time_out, began);
  while (!run_.endpoints.participant().has_way_to_all()) {
    if (host::stop_requested()) return false;
    if (patience.is_over(Clock::now())) {
      const config::Dds& dds = run_.launch.dds;
      run_.refuse(fmt::format("no hub of DDS domain {}{} in {} s: `launch` starts one, and so does `aurasim hub`",
                              dds.domain, dds.hub.empty() ? "" : " at " + dds.hub,
                              whole_seconds(Clock::now() - began)));
      return false;
    }
    run_.control().wait(20ms);
  }
  return true;
}

bool MeetingPhase::domain_is_free() {
  if (!finds_hub()) return false;
  const auto begin = Clock::now();
  // A node with a status has published a map, too, which may still be on its way.
  while (Clock::now() < begin + (run_.control().strangers().empty() ? kListenFirst : 6 * kListenFirst)) {
    if (host::stop_requested() || another_run_is_here()) return false;
    run_.control().wait(20ms);
  }
  return true;
}

/// True if another run is in the domain. Refuses to run then.
bool MeetingPhase::another_run_is_here() {
  const messages::Status& self = run_.status.content();
  const OwnRun own = {run_.options.region, run_.options.run,       self.agreement,         self.map_version,
                      run_.first_step(),   run_.launch.dds.domain, run_.launch.scene.name, run_.launch.regions.size()};
  std::string why = refusal_of_maps(run_.control().maps(), own);
  if (why.empty()) why = refusal_of_strangers(run_.control().strangers(), own, run_.endpoints.has_transport());
  if (why.empty()) return false;
  run_.refuse(why);
  return true;
}

bool MeetingPhase::receives_from_others() {
  return std::ranges::any_of(run_.control().statuses(),
                             [this](const auto& entry) { return entry.first != run_.options.region; });
}

bool MeetingPhase::agree_on_exchange() {
  if (run_.launch.exchange == config::Exchange::kAuto && !measure_exchange()) return false;
  const bool is_lead = run_.options.region == core::RegionId{0} && run_.launch.regions.size() > 1;
  if (!is_lead) return true;
  if (!run_.launch.why_exchange.empty()) spdlog::info("{}", words_of_only_choice(run_.launch));
  if (!run_.launch.is_coupled()) return true;
  if (const std::string moved = words_of_moved_borders(run_.launch); !moved.empty()) spdlog::info("{}", moved);
  return true;
}

bool MeetingPhase::measure_exchange() {
  const auto began = Clock::now();
  Patience patience(run_.options.start_time_out, began);
  host::LongWork waiting = waiting_for_nodes(run_.launch.regions.size());
  dds::RoundTrips trips(run_.endpoints.participant(), run_.options.region,
                        static_cast<std::uint32_t>(run_.launch.regions.size()), run_.launch.regions.version());
  RoundTripBook book(run_.launch.regions.size());
  while (run_.launch.exchange == config::Exchange::kAuto) {
    if (host::stop_requested() || another_run_is_here()) return false;
    measure(trips, book);
    run_.take_exchange_of_others();
    log_early_deaths();
    note_meeting(patience, waiting);
    if (gives_up("exchange: auto is not settled", patience, began)) return false;
    run_.publish();
    run_.control().wait(1ms);
  }
  return true;
}

/// The lead asks, and chooses when it knows enough. All others answer.
void MeetingPhase::measure(dds::RoundTrips& trips, RoundTripBook& book) {
  if (run_.options.region != core::RegionId{0}) return trips.answer();
  const auto taken = trips.take_answers();
  const auto now = Clock::now();
  for (const dds::RoundTrips::Answer& answer : taken) book.note_answer(answer.region, answer.number, now);
  for (const RoundTripBook::Question& question : book.take_due(now)) trips.ask(question.region, question.number);
  if (!book.is_complete(now)) return;
  const RoundTrip slowest = book.slowest();
  const double limit_s = run_.launch.exchange_limit_s();
  const config::Exchange chosen = choose_exchange(slowest, limit_s);
  spdlog::info("{}", words_of_choice(chosen, slowest, limit_s));
  if (std::isfinite(slowest.quartile_s)) run_.status.content().round_trip_ms = 1e3 * slowest.quartile_s;
  run_.use_exchange(chosen);
}

bool MeetingPhase::meet_neighbours() {
  const auto began = Clock::now();
  Patience patience(run_.options.start_time_out, began);
  setup::SilenceWord silence(run_.launch, run_.endpoints.participant());
  host::LongWork waiting = waiting_for_nodes(run_.launch.regions.size());
  while (!run_.transport().all_matched()) {
    if (host::stop_requested() || another_run_is_here()) return false;
    log_early_deaths();
    silence.look(receives_from_others());
    note_meeting(patience, waiting);
    if (patience.is_over(Clock::now())) {
      try {
        run_.transport().wait_until_matched(0ns);
      } catch (const dds::NeighboursMissing& missing) {
        const bool is_alone = !receives_from_others();
        run_.refuse(fmt::format(
            "the node has not met its neighbours in {} s, and for {} s there was nothing new: {}{}",
            whole_seconds(Clock::now() - began), whole_seconds(patience.waited(Clock::now())), missing.what(),
            is_alone ? setup::word_about_keys(run_.endpoints.participant().peers_by_keys(), run_.launch) : ""));
        return false;
      }
    }
    run_.control().wait(50ms);
  }
  if (another_run_is_here()) return false;
  run_.enter(NodeEvent::kMet);
  return true;
}

/// Refuses to run if patience with the other nodes is over. `what`: text that says what they have not done.
bool MeetingPhase::gives_up(std::string_view what, const Patience& patience, Clock::time_point began) {
  const auto now = Clock::now();
  if (!patience.is_over(now)) return false;
  run_.refuse(fmt::format("{} in {} s, and for {} s there was nothing new; {}", what, whole_seconds(now - began),
                          whole_seconds(patience.waited(now)),
                          who_does_not_wait(run_.control().statuses(), run_.launch.regions.size())));
  return true;
}

bool MeetingPhase::wait_for_start() {
  run_.publish();
  const auto began = Clock::now();
  Patience patience(run_.options.start_time_out, began);
  host::LongWork waiting = waiting_for_nodes(run_.launch.regions.size());
  while (!run_.start.start()) {
    if (host::stop_requested() || another_run_is_here()) return false;
    note_meeting(patience, waiting);
    if (gives_up("the run has not started", patience, began)) return false;
    log_early_deaths();
    run_.publish();
    run_.start_when_all_wait();
    executor_.execute_commands();
    run_.control().wait(50ms);
  }
  run_.enter(NodeEvent::kStarted);
  return true;
}

/// Notes how far all have met.
void MeetingPhase::note_meeting(Patience& patience, host::LongWork& waiting) {
  const SeenNodes& nodes = run_.control().statuses();
  const std::uint64_t found = run_.endpoints.has_transport() ? run_.transport().found() : 0;
  patience.look(progress_of_meeting(nodes, found), Clock::now());
  if (run_.options.region != core::RegionId{0}) return;
  waiting.reached(share_of_nodes(nodes, run_.options.region, run_.launch.regions.size()));
}

void MeetingPhase::log_early_deaths() {
  for (const std::string& text : early_deaths_.look(run_.control().statuses())) spdlog::warn("{}", text);
}

}  // namespace aurasim::process
