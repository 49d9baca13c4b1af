// Listening follows bodies (docs/design.md, "Who listens to whom"). Regions near each other always listen to each
// other. Where a body may come to a region that does not listen to its host, a node that listens to both introduces the
// two. A node also introduces two hosts whose bodies may come together in its territory. Both listen to each other from
// an agreed state on.
#pragma once

#include <span>
#include <vector>

#include "core/aura.h"
#include "core/foreign.h"
#include "core/ids.h"
#include "core/introduction.h"
#include "core/vicinity.h"

namespace aurasim::core {

/// Where those of a host's bodies that are near some region may come to before an introduction takes effect.
struct HostsReach {
  RegionId host{};
  Rectangle reach;
};

class Introducer {
 public:
  /// Keeps references to `aura` and `vicinity`.
  Introducer(const Aura& aura, const Vicinity& vicinity);

  /// Introductions that the foreign bodies call for, between hosts that we listen to; ascending. Valid until the next
  /// call.
  const std::vector<Introduction>& look(const ForeignBodies& foreign, double others_top_speed_m_s);

 private:
  void introduce(RegionId a, RegionId b);

  const Aura& aura_;
  const Vicinity& vicinity_;
  bool all_are_near_;               ///< every region is near every other, so none has to be introduced
  std::vector<HostsReach> guests_;  ///< hosts of bodies near our territory
  std::vector<Introduction> found_;
};

/// Regions, ascending, that region `self` has to listen to at the start besides those near it, because of bodies near
/// the same places. `hosts[i]` hosts body i of `scene`.
std::vector<RegionId> related_at_start(const Aura& aura, const RegionMap& map, double neighbour_distance_m,
                                       RegionId self, const Snapshot& scene, std::span<const RegionId> hosts);

}  // namespace aurasim::core
