// Transports one region's messages to and from other nodes over DDS (docs/design.md, "On the wire"): topics aura and
// migration. Readers are matched only with the neighbours' partitions. Samples arrive in DDS threads, which only wake
// the owner; decoding happens in take().
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "core/seam_mail.h"
#include "dds/participant.h"
#include "messages/wire_error.h"
#include "transport/transport.h"

namespace aurasim::dds {

struct ExchangeTimes;  // dds_seams.h

struct TransportSettings {
  core::RegionId region{};
  std::vector<core::RegionId> neighbours;
  std::uint64_t map_version = 0;  ///< messages of another map are refused and counted
  /// Generation with which the run went on after the last death; 0: no node has died. Endpoints of another generation
  /// are not matched: DDS holds the endpoints of a killed process for alive until its lease ends.
  core::Generation life = 0;
  std::uint32_t region_count = 0;  ///< number of regions in the map
  // Numbers of the scene's objects: messages with an index at or above these are refused. The default checks nothing.
  std::uint32_t prototype_count = 0xffff'ffffU;
  std::uint32_t static_count = 0xffff'ffffU;
  std::uint32_t joint_count = 0xffff'ffffU;
  bool coupled = false;  ///< regions are coupled: seams() is there, and all other regions are neighbours
  /// Where regions are coupled: those that exchange parcels with this one in every step (SeamSettings::near).
  std::vector<core::RegionId> near = {};
  double block_m = 0;  ///< side of the blocks; 0: not known, so blocks are not checked
  /// True when that region's node is alive but has been computing one step for long. Waiting to be matched by it then
  /// goes on until that step is done. Empty: no node counts as busy.
  std::function<bool(core::RegionId)> is_busy = {};
  /// Where regions are coupled: SeamSettings::why_stand.
  std::function<std::optional<std::string>()> why_stand = {};
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
  messages::WireErrors refused;
};

struct TransportCounters {
  TopicCounters aura;
  TopicCounters migration;
};

/// Thrown when neighbours were not matched in time. what() names them, and which endpoints of each are missing.
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
  /// True when every endpoint of every neighbour is matched, so that wait_until_matched would return at once.
  bool all_matched() const;
  /// Number of matched endpoints of neighbours; six of each when complete.
  std::size_t found() const;

  /// Fills `inbox` with what arrived. Messages of a neighbour that name this run and map but are not sound go to
  /// Inbox::refusals. Also reports neighbours: kLost once when the proof of life has ended, kJoined when a lost one is
  /// back and matched. The first match is no event. A process that dies is lost after one and a half leases of its aura
  /// writer; one that hangs, after Settings::hang_limit more; one that leaves, at once. One that restarts sooner gives
  /// kLost and then kJoined.
  void take(core::Inbox& inbox) override;
  /// Sends all messages of `outbox`. Never blocks for longer than the profiles' max_blocking_time (twice) per sample.
  void send(const core::Outbox& outbox) override;
  /// Returns when something arrived, when a neighbour was matched, unmatched or fell silent, or at the time-out.
  void wait_for_arrival(std::chrono::nanoseconds time_out) override;

  /// Parcels in the middle of a step; null unless TransportSettings::coupled.
  core::SeamMail* seams();
  /// Times of the exchanges of the last step; null unless TransportSettings::coupled.
  const ExchangeTimes* exchange_times();

  const TransportCounters& counters() const;
  /// Neighbours whose samples were refused, with the number of refused samples.
  std::vector<std::pair<core::RegionId, std::uint64_t>> refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
