// Finds pairs of bodies that have just come into contact, after collision detection and before the solver acts.
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

/// A first contact of two bodies, named by their user indices.
struct FirstContact {
  int body0 = 0;
  int body1 = 0;
  double penetration_m = 0;            ///< overlap at the deepest point
  double relative_speed_m_s = 0;       ///< relative speed at the deepest point
  btVector3 p_O = btVector3(0, 0, 0);  ///< the deepest point in Bullet's frame
};

/// Keeps its notes in two fields of the manifolds that Bullet does not use: m_companionIdA is the substep in which the
/// manifold last had a point, m_companionIdB the first one of that unbroken time.
class FirstContacts {
 public:
  /// Call once per substep, between collision detection and solver, with all manifolds of awake bodies that may have a
  /// point.
  void look(std::span<btPersistentManifold* const> manifolds, btOverlappingPairCache& pairs);

  // The same in two parts, of which the first can be called by several threads for different manifolds.
  /// Notes that a manifold with a point is there in the substep of the next report(). Returns true if report() has to
  /// get it, because it was not there in the substep before.
  bool note(btPersistentManifold& manifold) const;
  /// Reports manifolds whose note() has returned true.
  void report(std::span<btPersistentManifold* const> came, btOverlappingPairCache& pairs);

  /// Adds a contact that begins after look() within the step (soft/ahead.h). It does not count as new again in the next
  /// look().
  void add(const FirstContact& contact, const btBroadphasePair& pair);

  /// Marks a contact as known, so that the next look() does not report it: it came with its cache from another world,
  /// or its bodies slept until now.
  void know(btPersistentManifold& manifold) const;

  /// Marks a manifold as one that has never had a point.
  static void forget(btPersistentManifold& manifold);

  /// First contacts since the last clear(), in order of substeps. A pair may be listed more than once.
  const std::vector<FirstContact>& found() const { return found_; }
  void clear() { found_.clear(); }
  /// Frees the memory that many first contacts have used.
  void free_spare_memory() {
    new_ = {};
    found_.shrink_to_fit();
  }

 private:
  bool touched_before(const btPersistentManifold& manifold) const;
  void report_pair(const btPersistentManifold& manifold, btOverlappingPairCache& pairs);

  std::uint32_t now_ = 2;  ///< number of the substep; may wrap around
  std::vector<btPersistentManifold*> new_;
  std::vector<PartManifold> of_pair_;
  std::vector<FirstContact> found_;
};

}  // namespace aurasim::physics
