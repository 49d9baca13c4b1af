// Decides when a node process publishes replicas for all observers (node/replica_feed.h), over the topics of
// dds/replica_bus.h. Individual requests of observers are served by observation_publisher.h.
#pragma once

#include <chrono>
#include <optional>

#include "config/launch.h"
#include "dds/overlay_bus.h"
#include "dds/replica_bus.h"
#include "node/node.h"
#include "node/replica_feed.h"
#include "process/observation_publisher.h"

namespace aurasim::process {

class ReplicaPublisher {
 public:
  ReplicaPublisher(const config::Launch& launch, dds::Participant& participant, core::RegionId region);

  void begin_generation(core::Generation generation);
  /// To be called when the run goes back to state `step`. Later states that have not been published yet are published
  /// when they have been computed again, the first of them as a key frame.
  void put_back(core::Step step, core::Step confirmed);
  /// Publishes the bodies hosted here as a key frame of `generation`, even without observers.
  void publish_census(node::Node& node, core::Generation generation);
  void use_map(std::uint64_t map_version) { map_version_ = map_version; }
  /// To be called after the first state and after every step.
  void after_step(node::Node& node, const node::StepReport& report);
  /// Publishes the rest of the state in which the run is paused. May be called as often as wanted.
  void while_paused(node::Node& node);

 private:
  void compose(node::Node& node);
  void publish_cluster_graph(node::Node& node);
  bool key_frame_is_due() const;

  core::RegionId region_;
  std::uint64_t map_version_;
  core::Step tick_steps_;
  dds::ReplicaWriter writer_;
  dds::ClusterGraphWriter graphs_;
  ObservationPublisher observations_;
  std::optional<node::ReplicaFeed> feed_;
  core::Generation generation_ = 0;
  core::Step composed_ = -1;  ///< the newest state that is published or held back
  core::Step published_ = -1;
  HeldBack held_;
  std::uint64_t arrivals_ = 0;  ///< number of arrivals of observers that have got a key frame
  std::chrono::steady_clock::time_point last_key_frame_;
  std::chrono::steady_clock::time_point last_graph_;
};

}  // namespace aurasim::process
