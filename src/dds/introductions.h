// The hub of a run decides here whom it introduces to whom (dds.discovery: neighbours). Participants announce
// themselves to the hub only. Two of them meet when one has a writer that the other one has a matching reader for: the
// hub passes the announcement of each on to the other, and the two do the rest by themselves.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rtps/datagram_findings.h"

namespace aurasim::dds {

/// Where a participant receives announcements.
struct MeetingPoint {
  std::uint32_t address = 0;  ///< IPv4, 127.0.0.1 is 0x7f000001
  std::uint16_t port = 0;
  bool operator==(const MeetingPoint&) const = default;
};

struct DiscoveredEndpoint {
  rtps::WireGuid guid;
  bool is_writer = false;
  std::string topic;
  std::vector<std::string> partitions;  ///< names and patterns; none: the partition without a name
};

/// An announcement to be passed on.
struct Introduction {
  std::vector<std::uint8_t> announcement;
  MeetingPoint to;
};

/// True if endpoints with these partitions match (DDS 1.4, PARTITION): a name is equal, or matches a pattern.
bool share_a_partition(const std::vector<std::string>& a, const std::vector<std::string>& b);

/// Thread-safe; time is passed in.
class Introductions {
 public:
  using Time = std::chrono::nanoseconds;  ///< time of any monotonic clock

  /// Takes note of a datagram that announces its sender, of where a participant receives announcements, and of its end.
  void hear(std::span<const std::uint8_t> announcement);
  void add(const rtps::GuidPrefix& participant, MeetingPoint where);
  void remove(const rtps::GuidPrefix& participant);
  /// Takes note of an endpoint of a participant, or of its end.
  void add(DiscoveredEndpoint endpoint);
  void remove(const rtps::WireGuid& endpoint);

  /// Introductions that are due. Each pair is introduced kEagerly times in the first seconds, because a datagram may be
  /// lost, and then again every kPeriod with announcements that are newer than the last: two that have lost sight of
  /// each other meet again, and nobody is announced after its end.
  std::vector<Introduction> take_due(Time now);
  /// Number of pairs that have been introduced and are still there.
  std::size_t pairs() const;

  static constexpr std::array<std::chrono::milliseconds, 4> kEagerly = {
      std::chrono::milliseconds(0), std::chrono::milliseconds(100), std::chrono::milliseconds(500),
      std::chrono::milliseconds(2000)};  ///< times after the two have come to match
  static constexpr std::chrono::seconds kPeriod{5};
  static constexpr std::size_t kMostParticipants = 1024;

 private:
  struct Known {
    std::vector<std::uint8_t> announcement;
    std::uint64_t heard = 0;  ///< number of announcements
    MeetingPoint where;
  };
  struct Pair {
    std::size_t eager = 0;  ///< introductions of kEagerly that have been made
    Time since{-1};
    Time next{0};
    std::array<std::uint64_t, 2> passed_on{};  ///< which announcement of the first, and of the second, was the last
  };
  using Key = std::pair<rtps::GuidPrefix, rtps::GuidPrefix>;  ///< the smaller one first
  struct OfTopic {
    std::vector<DiscoveredEndpoint> writers, readers;
  };

  Known* known_or_new(const rtps::GuidPrefix& participant);
  void match(const DiscoveredEndpoint& endpoint, const std::vector<DiscoveredEndpoint>& others);

  mutable std::mutex mutex_;
  std::map<rtps::GuidPrefix, Known> participants_;
  std::map<std::string, OfTopic> topics_;
  std::map<Key, Pair> pairs_;
};

}  // namespace aurasim::dds
