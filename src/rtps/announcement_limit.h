// Limits how often a participant announces itself. Fast DDS 2.9.1 announces it to all known peers whenever it discovers
// another one (StatelessWriter::matched_reader_add), so n participants that start together send n^3 announcements. A
// peer that has just been given one needs no other; a new one is given it at once.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>

#include "rtps/peer.h"

namespace aurasim::rtps {

/// Number of the announcement if a datagram has the announcement of its sender and nothing else. Nothing: it is another
/// datagram, or says that the participant leaves.
std::optional<std::uint64_t> announcement_in(std::span<const std::uint8_t> datagram);

/// Thread-safe.
class AnnouncementLimit {
 public:
  using Time = std::chrono::nanoseconds;  ///< time of any monotonic clock

  /// `shortest`: time between two announcements to one peer. 0: no limit.
  explicit AnnouncementLimit(std::chrono::nanoseconds shortest) : shortest_(shortest) {}

  bool is_limited() const { return shortest_ > std::chrono::nanoseconds(0); }
  /// True if announcement `number` is to be sent to `peer`; it then counts as sent.
  bool allows(const Peer& peer, std::uint64_t number, Time now);

  static constexpr std::size_t kMostPeers = 4096;

 private:
  struct Sent {
    std::uint64_t number = 0;
    Time at{0};
  };

  std::chrono::nanoseconds shortest_;
  std::mutex mutex_;
  std::map<Peer, Sent> sent_;
};

}  // namespace aurasim::rtps
