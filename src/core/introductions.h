// Listening follows bodies (docs/design.md, "Who listens to whom"). Regions near each other always listen to each
// other. Where a body may come to a region that does not listen to its host, the owner of the place, which hears both,
// introduces them; so it does with two hosts whose bodies are over its territory. From an agreed state on they listen.
#pragma once

#include <span>
#include <vector>

#include "core/aura.h"
#include "core/foreign.h"
#include "core/ids.h"
#include "core/introduction.h"
#include "core/vicinity.h"

namespace aurasim::core {

class Introducer {
 public:
  /// Keeps references.
  Introducer(const Aura& aura, const Vicinity& vicinity);

  /// For the bodies of others, as far as we hear the hosts; ascending. Valid until the next call.
  const std::vector<Introduction>& look(const ForeignBodies& foreign, double others_top_speed_m_s);

 private:
  void introduce(RegionId a, RegionId b);

  const Aura& aura_;
  const Vicinity& vicinity_;
  bool all_are_near_;             ///< every region is near every other: nobody has to be introduced
  std::vector<RegionId> guests_;  ///< hosts of bodies near our territory
  std::vector<Introduction> found_;
};

/// Who has to listen to whom when `hosts[i]` hosts body i of `scene`, besides those near each other: those that region
/// `self` has to, ascending.
std::vector<RegionId> related_at_start(const Aura& aura, const RegionMap& map, double neighbour_distance_m,
                                       RegionId self, const Snapshot& scene, std::span<const RegionId> hosts);

}  // namespace aurasim::core
