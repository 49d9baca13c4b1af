// Puts the world together that all nodes go back to: the parts of all regions in one state, and the orders that any
// node knows by now. Each node sends the parts that the restore command asks it for, and the orders that it knows; the
// caller waits until those of all others have arrived.
#pragma once

#include <map>
#include <string>

#include "config/launch.h"
#include "core/world_cut.h"
#include "messages/control_messages.h"
#include "node/node.h"
#include "process/checkpoints.h"
#include "process/node_options.h"
#include "process/saving.h"

namespace aurasim::process {

class WorldGathering {
 public:
  /// The node's own parts that a gathering uses. All must outlive the gathering.
  struct Own {
    const config::Launch& launch;
    const NodeOptions& options;
    const Saving& saving;
    Checkpoints& checkpoints;
    const node::Node* node = nullptr;  ///< null: this process has no world
  };

  WorldGathering(const Own& own, const messages::RunCommand& restore) : own_(own), restore_(restore) {}

  /// True if the run begins again from its first state, which needs no parts.
  bool is_from_first() const { return restore_.count == 1; }
  /// Sends the parts of which this node is the holder.
  void send_parts();
  bool has_all_parts();
  /// Puts the world of the state together and sends the orders that this node knows, if it has survived. Precondition:
  /// has_all_parts().
  void send_orders();
  bool has_all_orders();
  /// The world with all orders. Precondition: has_all_orders().
  core::WorldCut take_world();
  /// The parts by region; none if the run begins from its first state.
  const std::map<core::RegionId, std::string>& parts() const { return parts_; }

 private:
  core::WorldCut first_world() const;
  core::WorldCut decode_part(const std::string& octets) const;
  void send(core::RegionId region, messages::Checkpoint::Kind kind, const std::string& octets);

  Own own_;
  messages::RunCommand restore_;
  std::map<core::RegionId, std::string> parts_;
  core::WorldCut whole_;
};

}  // namespace aurasim::process
