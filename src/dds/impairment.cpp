#include "dds/impairment.h"

#include <algorithm>

namespace aurasim::dds {
namespace {

/// Mixes a seed by SplitMix64, so that neighbouring numbers give unrelated ones.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e37'79b9'7f4a'7c15U;
  x = (x ^ (x >> 30)) * 0xbf58'476d'1ce4'e5b9U;
  x = (x ^ (x >> 27)) * 0x94d0'49bb'1331'11ebU;
  return x ^ (x >> 31);
}

ImpairedLink::Time seconds(double s) {
  return std::chrono::duration_cast<ImpairedLink::Time>(std::chrono::duration<double>(s));
}

}  // namespace

Impairment ImpairmentOverrides::over(Impairment impairment) const {
  impairment.delay_s = delay_s.value_or(impairment.delay_s);
  impairment.jitter_s = jitter_s.value_or(impairment.jitter_s);
  impairment.loss = loss.value_or(impairment.loss);
  impairment.bandwidth_B_s = bandwidth_B_s.value_or(impairment.bandwidth_B_s);
  impairment.reorder = reorder.value_or(impairment.reorder);
  impairment.discovery = discovery.value_or(impairment.discovery);
  impairment.seed = seed.value_or(impairment.seed);
  return impairment;
}

bool MetatrafficPorts::is_discovery(bool multicast, std::uint32_t port) const {
  if (multicast || std::ranges::find(servers, port) != servers.end()) return true;
  return port >= first_unicast && port < end && (port - first_unicast) % stride == 0;
}

ImpairedLink::ImpairedLink(const Impairment& impairment, std::uint64_t stream)
    : impairment_(impairment), random_(mixed(impairment.seed ^ mixed(stream))) {}

/// A random number from 0 to below 1. std::uniform_real_distribution is not used, because it may differ between
/// standard libraries.
double ImpairedLink::uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

ImpairedLink::Time ImpairedLink::leaves_the_bottleneck(Time now, std::size_t bytes) {
  if (impairment_.bandwidth_B_s <= 0) return now;
  bottleneck_free_ = std::max(now, bottleneck_free_) + seconds(static_cast<double>(bytes) / impairment_.bandwidth_B_s);
  return bottleneck_free_;
}

ImpairedLink::Verdict ImpairedLink::offer(Time now, std::uint64_t destination, std::size_t bytes) {
  // The number is drawn for every datagram, so that one setting does not shift the random numbers of another.
  const double luck = uniform();
  const double lateness_s = impairment_.delay_s + impairment_.jitter_s * (2 * uniform() - 1);
  if (counters_.queued_bytes + bytes > kMostQueuedBytes) {
    ++counters_.overflowed;
    return {Fate::kOverflows, now};
  }
  const Time sent = leaves_the_bottleneck(now, bytes);  // a lost datagram uses bandwidth, too
  if (luck < impairment_.loss) {
    ++counters_.lost;
    return {Fate::kLost, now};
  }
  if (!impairment_.delays()) {
    spare();
    return {Fate::kLeavesNow, now};
  }
  Time due = sent + seconds(std::max(0.0, lateness_s));
  if (!impairment_.reorder) {
    Time& last = last_due_.try_emplace(destination, due).first->second;
    due = last = std::max(due, last);
  }
  ++counters_.delayed;
  ++counters_.queued;
  counters_.queued_bytes += bytes;
  return {Fate::kWaits, due};
}

void ImpairedLink::leave(std::size_t bytes) {
  --counters_.queued;
  counters_.queued_bytes -= bytes;
}

}  // namespace aurasim::dds
