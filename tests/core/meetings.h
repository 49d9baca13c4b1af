// Pairs of bodies that are going to meet, for the tests of reach: where, when, how fast and from which side is random.
#pragma once

#include "core/kinematic_world.h"
#include "core/random.h"

namespace aurasim::core::testing {

/// Where bodies meet: within `spread_m` of one of `places` in the x-y plane.
struct Meeting {
  std::vector<Vec3> places;
  double spread_m = 0;
};

/// What a batch of meetings came to.
struct Tally {
  std::size_t pairs = 0;
  std::size_t apart = 0;  ///< started on different hosts
  std::size_t met = 0;
  std::size_t late = 0;
  std::uint64_t hand_offs = 0;
  std::uint64_t broken = 0;
  std::string first_late;

  void add(const KinematicWorld& world, std::size_t pairs_in_it);
  void add(const Tally& other);
};

/// Two spheres that first touch at a random instant, head on or obliquely, each at rest or at up to V.
class RandomPair {
 public:
  RandomPair(Random& random, const AuraRules& rules) : random_(random), rules_(rules) {}

  /// Places bodies 2 * slot and 2 * slot + 1 in `world`; slots are far apart in height.
  void place_in(KinematicWorld& world, std::uint32_t slot, const Meeting& meeting, PrototypeId a, PrototypeId b,
                const RoundShapes& shapes);
  /// Head on, both at V.
  void always_at_full_speed() { full_speed_ = true; }

  static Step steps(const AuraRules& rules) { return 12 * rules.lookahead + 18; }

 private:
  double speed();

  Random& random_;
  const AuraRules& rules_;
  bool full_speed_ = false;
};

}  // namespace aurasim::core::testing
