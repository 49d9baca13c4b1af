// Simulates a worse network: decides which datagrams are lost, and when the others leave. Pure and seeded; time is
// passed in, so that it can be tested without waiting. delay_line.h applies it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <unordered_map>
#include <vector>

namespace aurasim::dds {

/// Impairment of the datagrams that a participant sends. The default: none.
struct Impairment {
  double delay_s = 0;        ///< delay of each datagram, one way
  double jitter_s = 0;       ///< uniform: a datagram is delayed by delay_s +- jitter_s, never by less than 0
  double loss = 0;           ///< probability, 0 to 1, of each datagram for itself
  double bandwidth_B_s = 0;  ///< limit for all that a participant sends, UDP payload; 0: unlimited
  bool reorder = false;      ///< jitter may let one datagram overtake another; if not, both leave at the later time
  bool discovery = false;    ///< discovery (RTPS metatraffic) is impaired, too
  std::uint64_t seed = 1;

  bool any() const { return delays() || loss > 0; }
  bool delays() const { return delay_s > 0 || jitter_s > 0 || bandwidth_B_s > 0; }
};

// Upper limits of the fields; the lower limit is 0.
inline constexpr double kLongestDelay_s = 10;
inline constexpr double kLargestBandwidth_B_s = 1e12;
inline constexpr std::uint64_t kLargestSeed = INT64_MAX;

/// Impairment in a launch file: fields that are given override those of the profile.
struct ImpairmentOverrides {
  std::optional<double> delay_s = {}, jitter_s = {}, loss = {}, bandwidth_B_s = {};
  std::optional<bool> reorder = {}, discovery = {};
  std::optional<std::uint64_t> seed = {};

  Impairment over(Impairment impairment) const;
};

/// Counts datagrams; one sent to several destinations counts once for each.
struct ImpairmentCounters {
  std::uint64_t passed = 0;   ///< sent at once: discovery that is not impaired, and all datagrams if there is only loss
  std::uint64_t delayed = 0;  ///< datagrams held back, those that have left and those that still wait
  std::uint64_t lost = 0;     ///< dropped by `loss`
  std::uint64_t overflowed = 0;  ///< dropped, because too many bytes were waiting
  std::uint64_t queued = 0;      ///< waiting now
  std::uint64_t queued_bytes = 0;
};

/// Ports that distinguish discovery from user data. RTPS gives the participants of a domain fixed ports: one for
/// multicast, then for each participant one for discovery and one for user data.
struct MetatrafficPorts {
  std::uint32_t first_unicast = 7410;  ///< discovery port of participant 0 of the domain
  std::uint32_t stride = 2;            ///< distance from one participant's port to the next one's
  std::uint32_t end = 7650;            ///< end of the domain's ports (exclusive)
  std::vector<std::uint32_t> servers;  ///< ports of discovery servers

  /// True for discovery traffic. Multicast counts as discovery, because no reader of this program receives user data
  /// there.
  bool is_discovery(bool multicast, std::uint32_t port) const;
};

/// Decides for one participant's datagrams whether and when each leaves. Not thread-safe.
class ImpairedLink {
 public:
  using Time = std::chrono::nanoseconds;  ///< time of any monotonic clock

  enum class Fate : std::uint8_t { kLeavesNow, kWaits, kLost, kOverflows };
  struct Verdict {
    Fate fate;
    Time due;  ///< time to send it; only for kWaits
  };

  /// Most bytes that may wait; a datagram beyond them is dropped (kOverflows).
  static constexpr std::size_t kMostQueuedBytes = std::size_t{64} << 20;

  /// `stream` distinguishes participants of one seed: each has random numbers of its own.
  ImpairedLink(const Impairment& impairment, std::uint64_t stream);

  /// Decides for a datagram of `bytes` to `destination` (any number that stands for it), and counts it accordingly.
  Verdict offer(Time now, std::uint64_t destination, std::size_t bytes);
  /// Counts a datagram that is exempt from impairment.
  void spare() { ++counters_.passed; }
  /// Takes note that a waiting datagram of `bytes` has left.
  void leave(std::size_t bytes);

  const ImpairmentCounters& counters() const { return counters_; }

 private:
  Time leaves_the_bottleneck(Time now, std::size_t bytes);
  double uniform();  ///< next random number in [0, 1)

  Impairment impairment_;
  std::mt19937_64 random_;
  Time bottleneck_free_{0};
  std::unordered_map<std::uint64_t, Time> last_due_;  ///< by destination; only looked up
  ImpairmentCounters counters_;
};

}  // namespace aurasim::dds
