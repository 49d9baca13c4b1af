// A worse network than there is: which datagrams are lost, and when the others leave. Pure and seeded; time is passed
// in, so that it can be tested without waiting. delay_line.h puts it to work.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <unordered_map>
#include <vector>

namespace aurasim::dds {

/// What happens to the datagrams that a participant sends. The default: nothing.
struct Impairment {
  double delay_s = 0;        ///< one way
  double jitter_s = 0;       ///< uniform: a datagram is late by delay_s +- jitter_s, never by less than 0
  double loss = 0;           ///< probability, 0 to 1, of each datagram for itself
  double bandwidth_B_s = 0;  ///< of all that a participant sends, UDP payload; 0: unlimited
  bool reorder = false;      ///< jitter may let one datagram overtake another; if not, both leave at the later time
  bool discovery = false;    ///< discovery (RTPS metatraffic) suffers, too
  std::uint64_t seed = 1;

  bool any() const { return delays() || loss > 0; }
  bool delays() const { return delay_s > 0 || jitter_s > 0 || bandwidth_B_s > 0; }
};

// What the fields may be, from 0.
inline constexpr double kLongestDelay_s = 10;
inline constexpr double kLargestBandwidth_B_s = 1e12;
inline constexpr std::uint64_t kLargestSeed = INT64_MAX;

/// What a launch file says of it: the given fields win over those of the profile.
struct ImpairmentOverrides {
  std::optional<double> delay_s = {}, jitter_s = {}, loss = {}, bandwidth_B_s = {};
  std::optional<bool> reorder = {}, discovery = {};
  std::optional<std::uint64_t> seed = {};

  Impairment over(Impairment impairment) const;
};

/// Datagrams, one per destination.
struct ImpairmentCounters {
  std::uint64_t passed = 0;      ///< sent at once: discovery that is spared, and all if there is nothing but loss
  std::uint64_t delayed = 0;     ///< held back; those that have left and those that wait
  std::uint64_t lost = 0;        ///< dropped by `loss`
  std::uint64_t overflowed = 0;  ///< dropped, because too many bytes were waiting
  std::uint64_t queued = 0;      ///< waiting now
  std::uint64_t queued_bytes = 0;
};

/// Tells discovery from user data by the destination. RTPS gives the participants of a domain fixed ports: one for
/// multicast, then for each participant one for discovery and one for user data.
struct MetatrafficPorts {
  std::uint32_t first_unicast = 7410;  ///< of participant 0 of the domain
  std::uint32_t stride = 2;            ///< from one participant to the next
  std::uint32_t end = 7650;            ///< of the domain
  std::vector<std::uint32_t> servers;  ///< where discovery servers listen

  /// Multicast counts as discovery: no reader of ours listens to user data there.
  bool is_discovery(bool multicast, std::uint32_t port) const;
};

/// Decides over one participant's datagrams. Not thread-safe.
class ImpairedLink {
 public:
  using Time = std::chrono::nanoseconds;  ///< of any clock that does not go back

  enum class Fate : std::uint8_t { kLeavesNow, kWaits, kLost, kOverflows };
  struct Verdict {
    Fate fate;
    Time due;  ///< for kWaits
  };

  /// More bytes than these never wait.
  static constexpr std::size_t kMostQueuedBytes = std::size_t{64} << 20;

  /// `stream` tells participants of one seed apart: each has random numbers of its own.
  ImpairedLink(const Impairment& impairment, std::uint64_t stream);

  /// A datagram of `bytes` for `destination` (any number that stands for it). It is counted as said.
  Verdict offer(Time now, std::uint64_t destination, std::size_t bytes);
  /// One that was not to be impaired.
  void spare() { ++counters_.passed; }
  /// One that waited has left.
  void leave(std::size_t bytes);

  const ImpairmentCounters& counters() const { return counters_; }

 private:
  Time leaves_the_bottleneck(Time now, std::size_t bytes);
  double uniform();  ///< [0, 1)

  Impairment impairment_;
  std::mt19937_64 random_;
  Time bottleneck_free_{0};
  std::unordered_map<std::uint64_t, Time> last_due_;  ///< by destination; only looked up
  ImpairmentCounters counters_;
};

}  // namespace aurasim::dds
