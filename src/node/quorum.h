// Decides whether a node may go on after it has lost others. A host that is cut off sees the same as one whose
// neighbours have all died; if it went on, there would be two worlds. So a node that has lost others goes on only with
// the majority (docs/decisions/0012). Time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <set>

#include "core/ids.h"

namespace aurasim::node {

/// Signs of life of another region's node.
struct PeerSign {
  bool lost = false;  ///< its liveliness has ended
  bool left = false;  ///< it has published that it ends
  std::chrono::steady_clock::time_point heard;
};

enum class Standing : std::uint8_t {
  kGoOn,
  kWait,    ///< others were lost just now; too few of the rest have sent a message since then
  kCutOff,  ///< this node is not with the majority and has to stop
};

class Quorum {
 public:
  /// Regions 0 to `regions` - 1 are members until they leave. One that is lost stays a member: its region gets a node
  /// again, and until then the majority is one of all.
  Quorum(core::RegionId self, std::uint32_t regions);

  /// Judges whether this node may go on. Exactly half of the members is enough if the lowest member is among them. A
  /// region that is missing in `signs` counts as not received from. Precondition: `now` never goes back.
  Standing judge(const std::map<core::RegionId, PeerSign>& signs, std::chrono::steady_clock::time_point now);

  const std::set<core::RegionId>& members() const { return members_; }
  /// Members that are lost now.
  const std::set<core::RegionId>& lost() const { return lost_; }

 private:
  core::RegionId self_;
  std::set<core::RegionId> members_;
  std::set<core::RegionId> lost_;
  std::chrono::steady_clock::time_point lost_since_;  ///< when the latest of them was lost
};

}  // namespace aurasim::node
