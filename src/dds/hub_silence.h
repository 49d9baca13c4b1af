// Decides whether a node is lost whose statuses come by a hub only (dds.discovery: neighbours). DDS says nothing here
// of such a node's life, and on another host its process cannot be looked up. Time is passed in.
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "dds/watch.h"

namespace aurasim::dds {

class Speakers;

class HubSilence {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Takes note of which hubs are there, and that this process is awake.
  void look(const std::vector<RemoteWriter>& writers, const Speakers& speakers, Time now);
  /// True if a node is lost whose last status came at `heard`: no hub has passed one on for longer than `limit`, and
  /// all this time a hub was there that would have. So nobody is lost because a hub is, or because this process has
  /// slept or computed: what has come meanwhile is still to be taken then.
  bool is_believed(Time heard, std::chrono::nanoseconds limit, Time now) const;

  static constexpr std::chrono::seconds kSleep{3};  ///< a longer time between two looks is a sleep
  static constexpr std::chrono::seconds kAwake{1};  ///< then DDS has taken what has come meanwhile

 private:
  std::optional<Time> hub_since_;  ///< since when a hub is heard without a break; nothing: there is none
  std::optional<Time> awake_since_, last_look_;
};

}  // namespace aurasim::dds
