// Limits the traffic that is accepted from one source. Pure; time is passed in.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/token_bucket.h"
#include "rtps/recent.h"

namespace aurasim::rtps {

/// Source of a datagram: an IPv4 address, and the port of one participant's socket.
struct Source {
  std::uint32_t address = 0;  ///< 127.0.0.1 is 0x7f000001
  std::uint16_t port = 0;
};

/// Limits far above what a healthy node sends: 60 steps a second to some dozen neighbours, and now and then tens of MB
/// at once.
struct RateLimits {
  double datagrams_per_s = 50'000, datagrams_burst = 100'000;  ///< limits of one socket
  double bytes_per_s = 250e6, bytes_burst = 500e6;             ///< limits of one socket
  double address_datagrams_per_s = 400'000, address_datagrams_burst = 400'000;
  // Skipped sequence numbers. Each one costs Fast DDS a few ns with the reader's lock held, and each one in a gap also
  // costs memory.
  double jumps_per_s = 1U << 21, jumps_burst = 1U << 28;  ///< skipped by heartbeats, for one address
  double gaps_per_s = 1U << 12, gaps_burst = 1U << 19;    ///< skipped by gaps, for one address
};

class SourceLimits {
 public:
  using Time = core::TokenBucket::Time;

  explicit SourceLimits(const RateLimits& limits) : limits_(limits) {}

  /// Counts a datagram. Returns false when it exceeds the limit.
  bool take_datagram(Source source, std::size_t bytes, Time now);
  bool take_jump(std::uint32_t address, double numbers, Time now) {
    return address_of(address, now).jumps.take(numbers, now);
  }
  bool take_gap(std::uint32_t address, double numbers, Time now) {
    return address_of(address, now).gaps.take(numbers, now);
  }

  /// Most sockets and addresses that are counted one by one. Beyond these, the least recently active ones are forgotten
  /// and start afresh.
  static constexpr std::size_t kMostSockets = 4096, kMostAddresses = 1024;

 private:
  struct Socket {
    core::TokenBucket datagrams, bytes;
  };
  struct Address {
    core::TokenBucket datagrams, jumps, gaps;
  };

  Address& address_of(std::uint32_t address, Time now);

  RateLimits limits_;
  Recent<std::uint64_t, Socket> sockets_;
  Recent<std::uint32_t, Address> addresses_;
};

}  // namespace aurasim::rtps
