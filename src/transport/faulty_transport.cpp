#include "transport/faulty_transport.h"

#include <algorithm>

namespace aurasim::transport {

void FaultModel::cut(core::RegionId a, core::RegionId b, double from_s, double until_s) {
  cuts_.push_back({a, b, from_s, until_s});
}

double FaultModel::chance() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

double FaultModel::after_cuts(core::RegionId from, core::RegionId to, double t) const {
  for (bool held = true; held;) {
    held = false;
    for (const Cut& c : cuts_) {
      const bool concerns = (c.a == from && c.b == to) || (c.a == to && c.b == from);
      if (!concerns || t < c.from_s || t >= c.until_s) continue;
      t = c.until_s;
      held = true;
    }
  }
  return t;
}

double& FaultModel::last_arrival(core::RegionId from, core::RegionId to) {
  for (Last& l : last_) {
    if (l.from == from && l.to == to) return l.arrival_s;
  }
  return last_.emplace_back(Last{from, to, 0}).arrival_s;
}

double FaultModel::one_arrival(core::RegionId from, core::RegionId to, double now_s) {
  double t = after_cuts(from, to, now_s);
  while (chance() < faults_.loss) t = after_cuts(from, to, t + faults_.resend_after_s);
  t += faults_.latency_s + faults_.jitter_s * chance();
  if (faults_.keep_order) {
    double& last = last_arrival(from, to);
    t = last = std::max(t, last);
  }
  return t;
}

std::vector<double> FaultModel::arrivals(core::RegionId from, core::RegionId to, double now_s) {
  std::vector<double> times = {one_arrival(from, to, now_s)};
  if (chance() < faults_.duplicate) times.push_back(one_arrival(from, to, now_s));
  return times;
}

}  // namespace aurasim::transport
