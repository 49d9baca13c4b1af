// Watches the processes of a run's nodes before the run begins. A node that computes without end and publishes nothing
// holds up all others, and none of them can notice. Time is passed in.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/ids.h"
#include "dds/control.h"

namespace aurasim::launch {

class StartWatch {
 public:
  using Clock = std::chrono::steady_clock;

  StartWatch(std::size_t regions, std::chrono::seconds time_out, Clock::time_point now)
      : regions_(regions), time_out_(time_out + kNodesSpeakFirst), moved_(now) {}

  /// Why the run cannot begin. Nothing while there is progress. The problem is a node that has published no status for
  /// --start-time-out seconds and some more, while no other node has made progress either. Each node's progress starts
  /// the time anew, because many nodes may share few processors.
  std::optional<std::string> problem(const std::map<core::RegionId, messages::SeenStatus>& statuses,
                                     Clock::time_point now);

 private:
  /// Additional time. A node that waits in vain for another one ends the start itself, with a better message.
  static constexpr std::chrono::seconds kNodesSpeakFirst{10};
  using Progress = std::map<core::RegionId, std::pair<messages::NodeState, core::Step>>;

  std::size_t regions_;
  std::chrono::seconds time_out_;
  Progress progress_;
  Clock::time_point moved_;
};

}  // namespace aurasim::launch
