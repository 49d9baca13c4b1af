// The hub of a run with `dds.discovery: neighbours`. All processes of the run announce themselves to it alone. It
// introduces those to each other that have matching endpoints, and passes on what nodes say to all nodes, so that these
// need not meet (docs/decisions/0052).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "dds/settings.h"

namespace aurasim::dds {

class Hub {
 public:
  /// Joins the domain as its hub; `settings.introductions` is not used. Throws DdsError when the domain has a hub, or
  /// if it cannot be joined.
  explicit Hub(Settings settings);
  ~Hub();

  /// True if another process has the port of the domain's hub.
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
