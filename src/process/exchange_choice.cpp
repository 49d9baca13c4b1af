#include "process/exchange_choice.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "config/launch_checks.h"
#include "core/block_owners.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kPause = 5ms;              ///< from an answer to the next question
constexpr auto kPatienceWithOne = 100ms;  ///< with one question, until the next is sent
constexpr double kAskedAgain_s = 0.002;   ///< time until a lost parcel of a coupled step has come after all

}  // namespace

double RoundTrip::counts_s() const { return quartile_s + 2 * lost * kAskedAgain_s; }

RoundTripBook::RoundTripBook(std::size_t regions) {
  for (std::uint32_t r = 1; r < regions; ++r) links_[core::RegionId{r}];
}

/// True when the questions after the first that was answered are enough.
bool RoundTripBook::is_asked_enough(const Link& link) {
  return link.first_answered != 0 && link.asked - link.first_answered >= kQuestions;
}

std::vector<RoundTripBook::Question> RoundTripBook::take_due(Clock::time_point now) {
  std::vector<Question> due;
  for (auto& [region, link] : links_) {
    if (now < link.next || is_asked_enough(link)) continue;
    due.push_back({region, ++link.asked});
    link.open[link.asked] = link.last_asked = now;
    link.next = now + kPatienceWithOne;
  }
  return due;
}

void RoundTripBook::note_answer(core::RegionId region, std::uint32_t number, Clock::time_point now) {
  const auto found = links_.find(region);
  if (found == links_.end()) return;
  Link& link = found->second;
  const auto question = link.open.find(number);
  if (question == link.open.end()) return;
  if (link.first_answered == 0) {
    link.first_answered = number;  // before it, the other node may not have listened
    link.open.erase(link.open.begin(), link.open.upper_bound(number));
  } else {
    link.seconds.push_back(std::chrono::duration<double>(now - question->second).count());
    link.open.erase(question);
  }
  if (number == link.asked) link.next = now + kPause;
}

bool RoundTripBook::is_complete(Clock::time_point now) const {
  return std::ranges::all_of(links_, [now](const auto& entry) {
    const Link& link = entry.second;
    return is_asked_enough(link) && (link.open.empty() || now - link.last_asked >= kPatienceWithOne);
  });
}

RoundTrip RoundTripBook::slowest() const {
  RoundTrip slowest;
  for (const auto& [region, link] : links_) {
    std::vector<double> sorted = link.seconds;
    std::ranges::sort(sorted);
    RoundTrip trip{region, std::numeric_limits<double>::infinity(), 0};
    if (sorted.size() > kQuestions / 2) trip.quartile_s = sorted[sorted.size() / 4];
    trip.lost = static_cast<double>(link.open.size()) / static_cast<double>(link.seconds.size() + link.open.size());
    if (trip.counts_s() >= slowest.counts_s()) slowest = trip;
  }
  return slowest;
}

config::Exchange choose_exchange(const RoundTrip& slowest, double limit_s) {
  return slowest.counts_s() <= limit_s ? config::Exchange::kCoupled : config::Exchange::kAura;
}

std::string words_of_choice(config::Exchange chosen, const RoundTrip& slowest, double limit_s) {
  return fmt::format(
      "exchange: auto means {}: the slowest round trip, to region {}, takes {:.3g} ms, and {:.0f}% of the messages "
      "were "
      "lost; regions are coupled up to {:.3g} ms (exchange_limit)",
      chosen == config::Exchange::kCoupled ? "coupled" : "aura", core::value_of(slowest.region),
      1e3 * slowest.quartile_s, 100 * slowest.lost, 1e3 * limit_s);
}

std::string words_of_only_choice(const config::Launch& launch) {
  return fmt::format("exchange: auto means {}: {}", launch.is_coupled() ? "coupled" : "aura", launch.why_exchange);
}

std::string words_of_moved_borders(const config::Launch& launch) {
  constexpr double kLeast_m = 0.001;
  const double side_m = launch.block_m(), moved_m = core::farthest_move_m(launch.regions, side_m);
  if (moved_m < kLeast_m) return "";
  const auto other_m = core::side_that_moves_none(launch.regions, side_m);
  return fmt::format("coupled regions consist of whole blocks of {:g} m: borders are moved by up to {:.3g} m{}", side_m,
                     moved_m, other_m ? fmt::format("; physics.block: {:g} moves none", *other_m) : "");
}

std::string remedy_for_heaps(const config::Launch& launch, double round_trip_ms, bool is_one_host) {
  const std::string with_auras =
      "borders that do not run through the heap, a smaller time.lookahead or a smaller aura.uncertainty";
  if (!config::why_not_coupled(launch).empty()) return fmt::format("What may help: {}", with_auras);
  const double limit_ms = 1e3 * launch.exchange_limit_s();
  if (round_trip_ms > limit_ms) {
    return fmt::format(
        "exchange: coupled would divide them among the nodes, but a round trip of {:.3g} ms is too long for it. What "
        "may help: {}",
        round_trip_ms, with_auras);
  }
  return fmt::format(
      "exchange: coupled divides them among the nodes where round trips take up to {:.3g} ms{}. What "
      "may help, too: {}",
      limit_ms, is_one_host ? ", as they mostly do on one host" : "", with_auras);
}

messages::ExchangeInUse chosen_by_others(const std::map<core::RegionId, messages::SeenStatus>& nodes,
                                         std::uint64_t agreement) {
  for (const auto& [region, seen] : nodes) {
    if (seen.is_live() && seen.status.agreement == agreement &&
        seen.status.exchange != messages::ExchangeInUse::kNotChosen) {
      return seen.status.exchange;
    }
  }
  return messages::ExchangeInUse::kNotChosen;
}

messages::ExchangeInUse in_use(config::Exchange exchange) {
  switch (exchange) {
    case config::Exchange::kAura:
      return messages::ExchangeInUse::kAura;
    case config::Exchange::kCoupled:
      return messages::ExchangeInUse::kCoupled;
    case config::Exchange::kAuto:
      break;
  }
  return messages::ExchangeInUse::kNotChosen;
}

}  // namespace aurasim::process
