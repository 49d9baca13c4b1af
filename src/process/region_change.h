// The change of a run without coupled regions to other regions, step by step: all nodes publish the bodies that they
// host, compute the same new hosts, and send each body straight to its new host. Sends and receives, and never waits:
// the caller polls.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "dds/dds_transport.h"
#include "dds/replica_bus.h"
#include "node/node.h"
#include "node/repartition.h"
#include "process/node_endpoints.h"

namespace aurasim::process {

class RegionChange {
 public:
  /// `launch`: the run's present launch. `boxes`: the new regions, one rectangle each. `generation`: the present one.
  /// Throws BadConfig.
  RegionChange(const config::Launch& launch, const std::vector<core::Rectangle>& boxes, core::RegionId region,
               core::Generation generation);
  RegionChange(const RegionChange&) = delete;
  RegionChange& operator=(const RegionChange&) = delete;

  /// The launch with the new regions.
  const config::Launch& launch() const { return launch_; }
  /// Generation in which the bodies go to their new hosts. The new regions begin in the next one.
  core::Generation generation() const { return settings_.census; }

  /// Publishes the bodies that this node hosts. Precondition: no body is under way, and all nodes wait in one state.
  void begin_census(NodeEndpoints& endpoints, node::Node& node);
  bool has_census() const { return census_->complete(); }
  /// Receives what other nodes host; returns when something came, or after `time_out`.
  void receive_census(std::chrono::nanoseconds time_out);
  /// Computes the new hosts. Precondition: has_census().
  void end_census(const node::Node& node);
  /// Message for users: the regions that have not published what they host.
  std::string missing_in_census() const;

  /// Settings of the transport for the exchange: any region may send to any other.
  dds::TransportSettings transport_to_all() const;
  /// Sends bodies to their new hosts. Precondition: end_census() was called, and `transport` is connected.
  void begin_exchange(dds::DdsTransport& transport, node::Node& node);
  /// Takes in the messages that have arrived. True when every region has sent its bodies for this node.
  bool has_all_bodies() { return exchange_->ready(); }
  /// Message for users: the regions that have not sent their bodies.
  std::string missing_in_exchange() const;
  /// Adopts the bodies that have come. Returns the hand-offs. Precondition: has_all_bodies().
  node::StepReport finish(const node::Node& node);

 private:
  config::Launch launch_;
  node::RepartitionSettings settings_;  ///< its map is that of launch_
  std::unique_ptr<dds::ReplicaReader> reader_;
  std::optional<node::Census> census_;
  std::vector<core::Departure> departures_;
  std::optional<node::Exchange> exchange_;
};

}  // namespace aurasim::process
