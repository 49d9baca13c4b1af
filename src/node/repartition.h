// How bodies get to their new hosts when the run gets other regions. The world is held in one state, and every node has
// taken in all bodies that were on their way to it. Each node publishes what it hosts. All nodes compute the same new
// hosts, and each sends its bodies straight to them, with all that physics remembers of them. Uses no clock: the caller
// waits.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/aura.h"
#include "core/region_map.h"
#include "core/replica.h"
#include "node/node.h"
#include "transport/transport.h"

namespace aurasim::node {

struct RepartitionSettings {
  core::RegionId region{};
  core::Generation census = 0;  ///< generation of the key frames that list each node's bodies, and of the exchange
  core::AuraRules aura;
  const core::RegionMap* map = nullptr;  ///< the new map; must outlive all objects that take these settings
};

/// A body and its host.
struct Resident {
  core::BodyState state;
  core::RegionId host{};
};

/// Collects the host of every body in state `step`, from the key frames of all regions.
class Census {
 public:
  Census(const RepartitionSettings& settings, core::Step step);

  void accept(const core::Replica& replica);
  bool complete() const { return silent().empty(); }
  /// Regions whose key frame has not arrived.
  std::vector<std::uint32_t> silent() const;
  /// Takes all bodies with their hosts, ascending by body.
  std::vector<Resident> take();

 private:
  core::Generation generation_;
  std::uint32_t regions_;
  core::Step step_;
  std::map<core::RegionId, bool> received_;
  std::vector<Resident> residents_;
};

/// The bodies that have to leave `node`, with their new hosts. All nodes compute the same new hosts from the same
/// residents.
std::vector<core::Departure> find_new_hosts(const RepartitionSettings& settings, const std::vector<Resident>& residents,
                                            const Node& node);

/// Sends every body straight to its new host, and receives those that others send here.
class Exchange {
 public:
  /// Takes the departing bodies out of the world of `node` and sends them. `transport` reaches all regions under the
  /// new map. `transport` and `node` must outlive the exchange.
  Exchange(const RepartitionSettings& settings, const std::vector<core::Departure>& departures,
           transport::Transport& transport, Node& node);

  /// Takes in the messages that have arrived. True when every region has sent all its bodies for this node.
  bool ready();
  /// Regions that have not sent all their bodies for this node, ascending.
  std::vector<std::uint32_t> silent() const;
  /// Adopts the bodies that have come. Precondition: ready() was true. Returns the hand-offs in both directions, for
  /// the report.
  std::vector<HandOffRow> finish();

 private:
  core::Outbox pack(const std::vector<core::Departure>& departures);

  RepartitionSettings settings_;
  transport::Transport& transport_;
  Node& node_;
  core::Inbox inbox_;
  std::map<core::RegionId, bool> expects_;  ///< by region that has sent: whether it sends bodies here
  std::map<core::RegionId, core::HandOff> came_;
  std::vector<HandOffRow> rows_;
};

}  // namespace aurasim::node
