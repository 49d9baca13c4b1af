// Before a run begins: are the processes of its nodes still on their way? One that computes without end, without a
// word, holds up all others, and none of them can tell. Time is passed in.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/ids.h"
#include "dds/control.h"

namespace aurasim::cli {

class StartWatch {
 public:
  using Clock = std::chrono::steady_clock;

  StartWatch(std::size_t regions, std::chrono::seconds time_out, Clock::time_point now)
      : regions_(regions), time_out_(time_out + kNodesSpeakFirst), moved_(now) {}

  /// Why the run cannot begin: for --start-time-out seconds, and some more, a node has said nothing, and no other one
  /// has come a step further either. Where many nodes share few processors each one that does gives the rest as long
  /// again.
  std::optional<std::string> problem(const std::map<core::RegionId, dds::SeenStatus>& statuses, Clock::time_point now);

 private:
  /// A node that waits in vain for another one ends the start, too, and says for whom.
  static constexpr std::chrono::seconds kNodesSpeakFirst{10};
  using Progress = std::map<core::RegionId, std::pair<dds::NodeState, core::Step>>;

  std::size_t regions_;
  std::chrono::seconds time_out_;
  Progress progress_;
  Clock::time_point moved_;
};

}  // namespace aurasim::cli
