// How bodies find their new hosts when the run gets other regions. The world stands still in one state; every node has
// taken in all bodies that were on their way to it. Each node publishes what it hosts, all work out the same new
// hosts, and each sends its bodies straight there, with all that physics remembers of them.
#pragma once

#include <chrono>
#include <stdexcept>
#include <vector>

#include "config/launch.h"
#include "core/ids.h"
#include "dds/dds_transport.h"
#include "dds/participant.h"
#include "node/node.h"

namespace aurasim::cli {

/// What went wrong and with whom: the run cannot go on.
class RepartitionFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct RepartitionSettings {
  core::RegionId region{};
  core::Generation census = 0;  ///< generation of the key frames that say who hosts what
  std::chrono::steady_clock::time_point deadline;
};

/// New host of every body of the run that is hosted here, from the key frames of all regions. `launch` has the new map.
std::vector<core::Departure> find_new_hosts(const RepartitionSettings& settings, const config::Launch& launch,
                                            dds::Participant& participant, node::Node& node);

/// Sends and takes in. `transport` reaches all regions, under the new map.
/// Returns the hand-offs, for the report.
std::vector<node::HandOffRow> exchange(const RepartitionSettings& settings, const config::Launch& launch,
                                       const std::vector<core::Departure>& departures, dds::DdsTransport& transport,
                                       node::Node& node);

}  // namespace aurasim::cli
