// Which pairs of bodies have just come into contact, seen after collision detection and before the solver acts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <LinearMath/btVector3.h>

#include "physics/contact_cache.h"

struct btBroadphasePair;
class btOverlappingPairCache;
class btPersistentManifold;

namespace aurasim::physics {

/// Bodies are named by their user index.
struct FirstContact {
  int body0 = 0;
  int body1 = 0;
  double penetration_m = 0;            ///< of the deepest point
  double relative_speed_m_s = 0;       ///< at that point
  btVector3 p_O = btVector3(0, 0, 0);  ///< in Bullet's frame
};

/// Keeps its notes in two fields of the manifolds that Bullet does not use: m_companionIdA is the substep in which the
/// manifold last had a point, m_companionIdB the first one of that unbroken time.
class FirstContacts {
 public:
  /// Call once per substep, between collision detection and solver, with all manifolds that may have a point, but those
  /// of sleepers.
  void look(std::span<btPersistentManifold* const> manifolds, btOverlappingPairCache& pairs);

  /// A contact that look() does not see: when it looks, the two have not met yet. If it sees them next time, they are
  /// not new.
  void add(const FirstContact& contact, const btBroadphasePair& pair);

  /// A contact that has come with its cache from another world, or that was not shown as long as its bodies slept, is
  /// not a new one if it is seen next time.
  void know(btPersistentManifold& manifold) const;

  /// Since the last clear(), in order of substeps; a pair may be listed more than once.
  const std::vector<FirstContact>& found() const { return found_; }
  void clear() { found_.clear(); }

 private:
  bool touched_before(const btPersistentManifold& manifold) const;
  void report_pair(const btPersistentManifold& manifold, btOverlappingPairCache& pairs);

  std::uint32_t now_ = 2;  ///< substep; may wrap around
  std::vector<btPersistentManifold*> new_;
  std::vector<PartManifold> of_pair_;
  std::vector<FirstContact> found_;
};

}  // namespace aurasim::physics
