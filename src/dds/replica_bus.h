// Topics replica and replica_key: a node publishes, observers receive. An observer never holds up a node: samples that
// it is too slow for are overwritten.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/messages.h"
#include "core/replica.h"
#include "dds/observer_settings.h"
#include "dds/participant.h"

namespace aurasim::dds {

/// Used by one thread. The participant must outlive it.
class ReplicaWriter {
 public:
  ReplicaWriter(Participant& participant, core::RegionId region);
  ~ReplicaWriter();

  /// Publishes a replica: key frames on replica_key, all others on replica. Returns false when the write failed.
  bool send(const core::Replica& replica);
  bool anybody_listens() const;
  /// Counts observers that have joined so far.
  std::uint64_t arrivals() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Used by one thread. The participant must outlive it.
class ReplicaReader {
 public:
  ReplicaReader(Participant& participant, const ObserverSettings& settings);
  ~ReplicaReader();

  /// Returns the replicas that arrived since the last call, deltas before key frames.
  std::vector<core::Replica> take();
  /// Returns when something arrived, or at the time-out.
  void wait(std::chrono::nanoseconds time_out);

  std::uint64_t refused() const;
  std::uint64_t received() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
