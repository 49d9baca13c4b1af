// Limits what is reported of refusals: unknown processes must not be able to fill a log, and one that is refused often
// must not keep the others from being named. Time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace aurasim::dds {

class RefusalLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr auto kSayAgain = std::chrono::minutes(1);  ///< a text that was reported is left out for so long
  static constexpr auto kWindow = std::chrono::seconds(10);
  static constexpr std::uint64_t kMostOfOne = 6;    ///< texts about one participant in a window
  static constexpr std::uint64_t kMostOfAll = 100;  ///< texts in a window

  /// Returns the messages to report for a refusal of participant `who` (empty: unknown): `text`, preceded by the number
  /// of texts left out so far if there were any. Empty if `text` was just reported or there is too much to report.
  std::vector<std::string> worth_saying(const std::string& who, const std::string& text, Time now);

 private:
  static constexpr std::size_t kMostRemembered = 1024;

  std::map<std::string, Time> said_;             ///< when each text was reported
  std::map<std::string, std::uint64_t> of_one_;  ///< texts reported in this window, by participant
  std::uint64_t of_all_ = 0;                     ///< texts reported in this window
  std::uint64_t unsaid_ = 0;
  Time window_begin_{};
};

}  // namespace aurasim::dds
