// One region's nodes-to-nodes messages over DDS (docs/design.md, "On the wire"): topics aura, migration and
// migration_ack.
// Readers name only the neighbours' partitions. Samples arrive in DDS threads, which do no more than wake the owner;
// decoding happens in take().
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "dds/participant.h"
#include "dds/wire_error.h"
#include "transport/transport.h"

namespace aurasim::dds {

struct TransportSettings {
  core::RegionId region{};
  std::vector<core::RegionId> neighbours;
  std::uint64_t map_version = 0;  ///< messages of another map are refused and counted
  /// Generation with which the run goes on after a death; 0: nobody has died. Who is of another one is not met: DDS
  /// holds the endpoints of a process that was killed for alive until its lease ends.
  core::Generation life = 0;
  std::uint32_t region_count = 0;  ///< of the map
  // Of the scene: messages that name an index at or above these are refused. What is not given is not checked.
  std::uint32_t prototype_count = 0xffff'ffffU;
  std::uint32_t static_count = 0xffff'ffffU;
  std::uint32_t joint_count = 0xffff'ffffU;
  /// Does that region's node live, and compute one step for long? Whoever is to be listened to by it waits until it
  /// has. Empty: none does.
  std::function<bool(core::RegionId)> is_busy = {};
};

/// Samples and bytes (serialized, without RTPS headers) of one topic, all neighbours together.
struct TopicCounters {
  std::uint64_t sent = 0;
  std::uint64_t sent_bytes = 0;
  std::uint64_t received = 0;
  std::uint64_t received_bytes = 0;
  std::uint64_t retried = 0;      ///< writes that needed a second try
  std::uint64_t send_failed = 0;  ///< writes that failed twice: the sample is lost
  std::uint64_t not_sent = 0;     ///< not written, because the destination is lost
  WireErrors refused;
};

struct TransportCounters {
  TopicCounters aura;
  TopicCounters migration;
  TopicCounters migration_ack;
};

/// Neighbours that were not there in time; what() names them and what is missing of each.
class NeighboursMissing : public DdsError {
 public:
  NeighboursMissing(const std::string& what, std::vector<core::RegionId> regions)
      : DdsError(what), regions_(std::move(regions)) {}
  const std::vector<core::RegionId>& regions() const { return regions_; }

 private:
  std::vector<core::RegionId> regions_;
};

/// Used by one thread. The participant must outlive it.
class DdsTransport final : public transport::Transport {
 public:
  /// Throws DdsError when an endpoint cannot be created, std::invalid_argument for bad settings (a region that is its
  /// own neighbour, or named twice).
  DdsTransport(Participant& participant, const TransportSettings& settings);
  ~DdsTransport() override;

  /// Returns when every neighbour's readers and writers of all three topics are matched with this region's.
  /// Throws NeighboursMissing at the time-out. What is sent after a match is not lost.
  void wait_until_matched(std::chrono::nanoseconds time_out);
  /// True when wait_until_matched would return at once.
  bool all_matched() const;
  /// How many endpoints of neighbours have been found, of six for each.
  std::size_t found() const;

  /// Messages of a neighbour that are of this run and map but not sound go to Inbox::refusals.
  /// Also reports neighbours whose proof of life has ended: kLost once, kJoined when one that was lost is back and
  /// matched. A process that dies is lost after one and a half leases of its aura writer, one that hangs after
  /// Settings::hang_limit more, one that leaves at once; one that was restarted before that gives kLost and then
  /// kJoined. The first meeting is no event.
  void take(core::Inbox& inbox) override;
  /// Never blocks for longer than the profiles' max_blocking_time (twice) per sample.
  void send(const core::Outbox& outbox) override;
  /// Also returns when a neighbour was matched, unmatched or fell silent.
  void wait_for_arrival(std::chrono::nanoseconds time_out) override;

  const TransportCounters& counters() const;
  /// Neighbours that samples were refused of, and how many.
  std::vector<std::pair<core::RegionId, std::uint64_t>> refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
