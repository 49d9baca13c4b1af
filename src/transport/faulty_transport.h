// Simulates the faults of a bad network for each message, from a seed: the same seed gives the same run.
#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "core/ids.h"

namespace aurasim::transport {

/// Faults of a link. Delivery is at least once, as from a reliable writer over a lossy link: lost datagrams are sent
/// again later.
struct Faults {
  double latency_s = 0;
  double jitter_s = 0;           ///< uniform extra delay
  double loss = 0;               ///< probability that one datagram is lost
  double resend_after_s = 0.01;  ///< time until a lost datagram is sent again
  double duplicate = 0;          ///< probability that a message arrives twice
  bool keep_order = true;        ///< keeps the order of messages of each pair of regions; false: jitter may change it
};

class FaultModel {
 public:
  FaultModel(const Faults& faults, std::uint64_t seed) : faults_(faults), random_(seed) {}

  /// Cuts the link between `a` and `b` from `from_s` until `until_s`. Messages sent meanwhile arrive afterwards.
  void cut(core::RegionId a, core::RegionId b, double from_s, double until_s);

  /// Times at which a message sent at `now_s` arrives: one, or two if it is duplicated. Seconds.
  std::vector<double> arrivals(core::RegionId from, core::RegionId to, double now_s);

 private:
  struct Cut {
    core::RegionId a, b;
    double from_s, until_s;
  };
  struct Last {
    core::RegionId from, to;
    double arrival_s;
  };

  double chance();
  double one_arrival(core::RegionId from, core::RegionId to, double now_s);
  double after_cuts(core::RegionId from, core::RegionId to, double t) const;
  double& last_arrival(core::RegionId from, core::RegionId to);

  Faults faults_;
  std::mt19937_64 random_;
  std::vector<Cut> cuts_;
  std::vector<Last> last_;
};

}  // namespace aurasim::transport
