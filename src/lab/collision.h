// The collision experiments of the thesis (sections 5.2.2 and 5.2.3): do two bodies that fly at each other across a
// border meet as they would in one world, and does a node know when they may not?
#pragma once

#include <vector>

#include "lab/campaign.h"

namespace aurasim::lab {

struct CollisionPlan {
  std::vector<PairKind> pairs;
  std::vector<AuraChoice> auras;
  std::vector<core::SyncMode> syncs;
  std::uint32_t repeats = 50;
  std::size_t values_of_head_on_pairs = 0;  ///< number of values of each series, evenly spread; 0: all of the thesis
  /// The same number for other kinds of pairs.
  std::size_t values_of_other_pairs = 4;
};

Campaign collision_campaign(const CollisionPlan& plan);
/// Head-on pairs with 0 to 20% of the datagrams lost, everything else at its tolerance (thesis section 5.2.5).
Campaign loss_campaign(const CollisionPlan& plan);

}  // namespace aurasim::lab
