// Chooses how bodies of two regions touch in a run with `exchange: auto`: coupled where the round trips between the
// nodes are short, else by auras. Uses no DDS: time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "config/launch.h"
#include "core/ids.h"
#include "messages/control_messages.h"

namespace aurasim::process {

/// The link between the lead and one region, as measured.
struct RoundTrip {
  core::RegionId region{};
  double quartile_s = 0;  ///< the lower one: what the link takes when both nodes have a processor; infinite if most
                          ///< questions got no answer
  double lost = 0;        ///< share of questions without an answer, 0 to 1

  /// The round trip that counts, s. An exchange takes half of it, on average: a lost message comes after it was asked
  /// for again.
  double counts_s() const;
};

/// Questions of the lead to all other regions, and the answers.
class RoundTripBook {
 public:
  using Clock = std::chrono::steady_clock;
  struct Question {
    core::RegionId region{};
    std::uint32_t number = 0;
  };

  static constexpr std::size_t kQuestions = 20;  ///< that are counted, for each region

  /// Regions 1 to `regions` - 1 are asked.
  explicit RoundTripBook(std::size_t regions);

  /// Questions to be sent now. The next one to a region follows soon after the answer, or after some time without one.
  std::vector<Question> take_due(Clock::time_point now);
  void note_answer(core::RegionId region, std::uint32_t number, Clock::time_point now);
  /// True when enough questions to each region have been answered or are lost.
  bool is_complete(Clock::time_point now) const;
  /// The link with the longest round trip. Precondition: is_complete().
  RoundTrip slowest() const;

 private:
  struct Link {
    std::uint32_t asked = 0;
    std::uint32_t first_answered = 0;  ///< 0: no answer has come yet. Earlier questions do not count
    Clock::time_point last_asked, next;
    std::map<std::uint32_t, Clock::time_point> open;  ///< questions without an answer
    std::vector<double> seconds;                      ///< round trips that count
  };

  static bool is_asked_enough(const Link& link);

  std::map<core::RegionId, Link> links_;
};

/// The exchange that the lead chooses.
config::Exchange choose_exchange(const RoundTrip& slowest, double limit_s);
/// Text for the log: what was chosen, and why.
std::string words_of_choice(config::Exchange chosen, const RoundTrip& slowest, double limit_s);

/// The same where `auto` in the launch file can mean only one of the two.
std::string words_of_only_choice(const config::Launch& launch);

/// Text for users: how far borders of coupled regions are moved to edges of blocks, and how not to. Empty: they are
/// not.
std::string words_of_moved_borders(const config::Launch& launch);

/// Text for users: the keys that help a run with auras whose bodies are one cluster. `round_trip_ms`: as in the status.
std::string remedy_for_heaps(const config::Launch& launch, double round_trip_ms, bool is_one_host);

/// The exchange that live nodes of the run have chosen already, if any has.
messages::ExchangeInUse chosen_by_others(const std::map<core::RegionId, messages::SeenStatus>& nodes,
                                         std::uint64_t agreement);
messages::ExchangeInUse in_use(config::Exchange exchange);

}  // namespace aurasim::process
