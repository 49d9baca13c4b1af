// Listening follows bodies (docs/design.md, "Who listens to whom"). Regions near each other always listen to each
// other. Where a body may come to a region that does not listen to its host, a node that listens to both introduces the
// two. A node also introduces two hosts whose bodies may come together in its territory. Both listen to each other from
// an agreed state on, and as long as anybody introduces them. So a node also introduces itself to hosts that it listens
// to.
#pragma once

#include <span>
#include <vector>

#include "core/aura.h"
#include "core/foreign.h"
#include "core/ids.h"
#include "core/introduction.h"
#include "core/vicinity.h"

namespace aurasim::core {

/// Where bodies of several hosts may come to before an introduction takes effect: a rectangle for each body.
class HostsReaches {
 public:
  void clear() { bodies_.clear(); }
  void add(RegionId host, const Rectangle& reach) { bodies_.push_back({host, reach}); }
  /// Calls visit(a, b), a < b, for each two hosts of which bodies may come together, if is_wanted(a, b).
  template <class IsWanted, class Visit>
  void for_each_meeting(IsWanted&& is_wanted, Visit&& visit);

 private:
  struct Reach {
    RegionId host{};
    Rectangle reach;
  };
  struct Host {
    RegionId id{};
    Rectangle reach;  ///< holds those of all of its bodies
    std::span<const Reach> bodies;
  };
  void group_by_host();
  static bool may_meet(const Host& one, const Host& other);

  std::vector<Reach> bodies_;
  std::vector<Host> hosts_;  ///< made by group_by_host()
};

class Introducer {
 public:
  /// Keeps references to `aura` and `vicinity`.
  Introducer(const Aura& aura, const Vicinity& vicinity);

  /// Introductions that the foreign bodies call for, between our region and those that we listen to; ascending. Valid
  /// until the next call.
  const std::vector<Introduction>& look(const ForeignBodies& foreign, double others_top_speed_m_s);

 private:
  bool may_introduce(RegionId a, RegionId b) const;
  void introduce(RegionId a, RegionId b);

  const Aura& aura_;
  const Vicinity& vicinity_;
  bool all_are_near_;    ///< every region is near every other, so none has to be introduced
  HostsReaches guests_;  ///< of bodies near our territory
  std::vector<Introduction> found_;
};

/// Regions, ascending, that region `self` has to listen to at the start besides those near it, because of bodies near
/// the same places. `hosts[i]` hosts body i of `scene`.
std::vector<RegionId> related_at_start(const Aura& aura, const RegionMap& map, double neighbour_distance_m,
                                       RegionId self, const Snapshot& scene, std::span<const RegionId> hosts);

}  // namespace aurasim::core
