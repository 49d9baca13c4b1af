// When a node process publishes what for observers (node/replica_feed.h), and over which topic (dds/replica_bus.h).
// What each of them has asked for is another matter (observation_publisher.h).
#pragma once

#include <chrono>
#include <optional>

#include "cli/observation_publisher.h"
#include "config/launch.h"
#include "dds/overlay_bus.h"
#include "dds/replica_bus.h"
#include "node/node.h"
#include "node/replica_feed.h"

namespace aurasim::cli {

class ReplicaPublisher {
 public:
  ReplicaPublisher(const config::Launch& launch, dds::Participant& participant, core::RegionId region);

  void begin_generation(core::Generation generation);
  /// The run goes back: nothing is published until it is where it was, and then everything anew.
  void put_back();
  /// The bodies that are here, whoever listens, as a key frame of `generation`.
  void publish_census(node::Node& node, core::Generation generation);
  void use_map(std::uint64_t map_version) { map_version_ = map_version; }
  /// After the first state and after every step.
  void after_step(node::Node& node, const node::StepReport& report);
  /// As often as you like while the run stands still: what was not published yet of the state that it stands in.
  void while_paused(node::Node& node);

 private:
  void publish(node::Node& node);
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
  core::Step published_ = -1;
  std::uint64_t arrivals_ = 0;  ///< observers that have got a key frame of their own
  std::chrono::steady_clock::time_point last_key_frame_;
  std::chrono::steady_clock::time_point last_graph_;
};

}  // namespace aurasim::cli
