// The DDS endpoints of a node's process. The participant and the control topics come first; the others are made once
// the domain is known to be free, made anew when the run gets other regions, and moved when the process leaves DDS and
// joins it again.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "config/launch.h"
#include "dds/control.h"
#include "dds/dds_transport.h"
#include "dds/participant.h"
#include "dds/setpoint_bus.h"
#include "node/quorum.h"
#include "process/checkpoints.h"
#include "process/command_server.h"
#include "process/node_options.h"
#include "process/replica_publisher.h"
#include "process/ros2_link.h"

namespace aurasim::process {

/// Settings of the transport between a region and its neighbours.
dds::TransportSettings neighbour_transport(const config::Launch& launch, core::RegionId region);

class NodeEndpoints {
 public:
  /// Joins DDS. Both must outlive this object; `launch` is the run's present launch, also after changes.
  NodeEndpoints(const config::Launch& launch, const NodeOptions& options);

  /// Makes all other endpoints. Precondition: no other run is in the domain.
  void open(const dds::TransportSettings& settings);
  /// Makes the endpoint for kept parts. A process that takes a region over needs nothing else until it has a world.
  void open_checkpoints();
  void open_ros2();
  /// Makes the transport to the neighbours anew.
  void connect(const dds::TransportSettings& settings);
  /// Makes the endpoints for observers, clients and programs anew if the run has other regions than they were made for.
  void serve_map();
  /// The endpoints for observers, clients and programs have been changed to the launch's present regions.
  void note_served_map() { served_map_ = launch_.regions.version(); }
  /// Leaves DDS and joins it again as a new participant (Recovery::meets_anew). `settings`: of the transport.
  void join_anew(const dds::TransportSettings& settings);
  /// Sends what is still delayed, and logs what the simulated network and the guard have refused. The process leaves
  /// afterwards without destroying its endpoints, so delayed messages would never be sent.
  void flush();

  dds::Participant& participant() { return *participant_; }
  dds::ControlBus& control() { return control_; }
  dds::DdsTransport& transport() { return *transport_; }
  ReplicaPublisher& observers() { return *observers_; }
  CommandServer& commands() { return *command_server_; }
  dds::SetpointReader& programs() { return *programs_; }
  Checkpoints& checkpoints() { return *checkpoints_; }
  /// False until open(), and in a process that takes a region over until it connects.
  bool has_transport() const { return transport_.has_value(); }
  bool has_checkpoints() const { return checkpoints_.has_value(); }
  /// True if no other node can be on another host.
  bool stays_on_this_host() const { return participant_->stays_on_this_host(); }

  /// Setpoints for this generation that arrived since the last call, of topic control and of ROS 2.
  std::vector<core::Setpoints> take_setpoints(core::Generation generation);
  std::uint64_t refused_setpoints() const;
  /// Publishes to ROS 2 between two states, if the launch file asks for it. The live node of the lowest region also
  /// publishes the time.
  void publish_ros2(node::Node& node, core::Generation generation);
  /// To be called when the run goes back to state `step`. Observers get later states when they have been computed
  /// again.
  void put_back(core::Step step, core::Step confirmed);
  /// Signs of life of all other regions, for the fence. A region whose node was never received from since this process
  /// joined DDS counts as lost.
  std::map<core::RegionId, node::PeerSign> peer_signs();
  /// True if this is the live node of the lowest region.
  bool leads();

 private:
  const config::Launch& launch_;
  const NodeOptions& options_;
  std::unique_ptr<dds::Participant> participant_;
  dds::ControlBus control_;
  std::optional<dds::DdsTransport> transport_;
  std::optional<ReplicaPublisher> observers_;
  std::optional<CommandServer> command_server_;
  std::optional<dds::SetpointReader> programs_;
  std::optional<Ros2Link> ros2_;  ///< only if ros2 is on
  std::optional<Checkpoints> checkpoints_;
  std::uint64_t served_map_ = 0;  ///< map version that observers and clients are served for
};

}  // namespace aurasim::process
