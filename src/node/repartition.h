// How bodies find their new hosts when the run gets other regions. The world stands still in one state; every node has
// taken in all bodies that were on their way to it. Each node tells all others what it hosts, all work out the same new
// hosts, and each sends its bodies straight there, with all that physics remembers of them. No clock: the caller waits.
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
  core::Generation census = 0;  ///< generation of the key frames that say who hosts what, and of the exchange
  core::AuraRules aura;
  const core::RegionMap* map = nullptr;  ///< the new one; outlives all that takes these settings
};

/// A body and who hosts it.
struct Resident {
  core::BodyState state;
  core::RegionId host{};
};

/// Who hosts what in state `step`, from the key frames of all regions.
class Census {
 public:
  Census(const RepartitionSettings& settings, core::Step step);

  void accept(const core::Replica& replica);
  bool complete() const { return silent().empty(); }
  /// Regions that have not published what they host.
  std::vector<std::uint32_t> silent() const;
  /// Ascending by body.
  std::vector<Resident> take();

 private:
  core::Generation generation_;
  std::uint32_t regions_;
  core::Step step_;
  std::map<core::RegionId, bool> received_;
  std::vector<Resident> residents_;
};

/// Who leaves `node` for whom. The same answer on every node for the same residents.
std::vector<core::Departure> find_new_hosts(const RepartitionSettings& settings, const std::vector<Resident>& residents,
                                            const Node& node);

/// Every body goes straight to its new host.
class Exchange {
 public:
  /// Takes the departures out of the world and sends them. `transport` reaches all regions, under the new map. Both
  /// outlive this.
  Exchange(const RepartitionSettings& settings, const std::vector<core::Departure>& departures,
           transport::Transport& transport, Node& node);

  /// Takes in the mail. True when every region has sent what it sends us.
  bool ready();
  /// Regions that have not, ascending.
  std::vector<std::uint32_t> silent() const;
  /// Once ready: adopts what has come. Returns the hand-offs, both ways, for the report.
  std::vector<HandOffRow> finish();

 private:
  core::Outbox pack(const std::vector<core::Departure>& departures);

  RepartitionSettings settings_;
  transport::Transport& transport_;
  Node& node_;
  core::Inbox inbox_;
  std::map<core::RegionId, bool> expects_;  ///< by region that has spoken: does it send us bodies?
  std::map<core::RegionId, core::HandOff> came_;
  std::vector<HandOffRow> rows_;
};

}  // namespace aurasim::node
