// Data that pages draw over the bodies: auras as the nodes publish them, and topic cluster_graph, which a node writes
// only while it has a reader.
#pragma once

#include <memory>
#include <vector>

#include "core/cluster_graph.h"
#include "core/messages.h"
#include "dds/participant.h"
#include "dds/replica_bus.h"

namespace aurasim::dds {

/// Used by one thread. The participant must outlive it.
class ClusterGraphWriter {
 public:
  ClusterGraphWriter(Participant& participant, core::RegionId region);
  ~ClusterGraphWriter();

  bool anybody_listens() const;
  /// Sends the graph if that is possible at once. Otherwise it is dropped: the next tick sends a new one.
  void send(const core::ClusterGraph& graph);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Receives the cluster graphs of all regions; some may be missed. The participant must outlive it.
class ClusterGraphWatch {
 public:
  ClusterGraphWatch(Participant& participant, const ObserverSettings& settings);
  ~ClusterGraphWatch();

  std::vector<core::ClusterGraph> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Receives the auras of all regions; some may be missed. The participant must outlive it.
class AuraWatch {
 public:
  AuraWatch(Participant& participant, const ObserverSettings& settings);
  ~AuraWatch();

  std::vector<core::AuraBatch> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
