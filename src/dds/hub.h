// The hub of a run with `dds.discovery: neighbours`, or of one of its sites. All processes of the site announce
// themselves to it alone. It introduces those to each other that have matching endpoints, and passes on what nodes say
// to all nodes, so that these need not meet (docs/decisions/0052, 0056).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "dds/settings.h"

namespace aurasim::dds {

class Hub {
 public:
  /// Joins the domain as the hub at `settings.hub`, with the hubs of other sites at `settings.peers`;
  /// `settings.introductions` is not used. Throws DdsError when there is one at this address, or if the domain cannot
  /// be joined.
  explicit Hub(Settings settings);
  ~Hub();

  /// True if another process has the port of the hub, or its address is not one of this host.
  static bool is_there(const Settings& settings);

  /// Waits until something has come, at most `time_out`, and passes it on.
  void turn(std::chrono::nanoseconds time_out);

  struct Counts {
    std::uint64_t passed = 0;   ///< samples passed on
    std::uint64_t failed = 0;   ///< samples that could not be written
    std::uint64_t refused = 0;  ///< statuses in the name of another region, which are not passed on
    std::size_t pairs = 0;      ///< pairs of processes that have been introduced and are there
  };
  Counts counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
