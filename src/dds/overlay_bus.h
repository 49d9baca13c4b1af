// What pages draw over the bodies: auras as the nodes publish them, and topic cluster_graph, which a node writes only
// while somebody listens.
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
  /// What cannot be sent at once is not sent: the next tick sends all anew.
  void send(const core::ClusterGraph& graph);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The cluster graphs of all regions: some may be missed. The participant must outlive it.
class ClusterGraphWatch {
 public:
  ClusterGraphWatch(Participant& participant, const ObserverSettings& settings);
  ~ClusterGraphWatch();

  std::vector<core::ClusterGraph> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The auras of all regions: some may be missed. The participant must outlive it.
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
