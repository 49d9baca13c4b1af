// The contact points of awake bodies, as the soft step solves them: in patches of one normal, coloured so that those of
// a colour share no body that moves, side by side in blocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "physics/soft/lanes.h"

class btPersistentManifold;
class btRigidBody;

namespace aurasim::physics {

class SoftPatches {
 public:
  /// Of a substep of h_s.
  explicit SoftPatches(soft::Real h_s);

  void clear();
  /// The contacts of an island, in an order that follows from the island alone: so do the colours. Of statics a
  /// manifold's body has no mover (0), of others its companion id says which.
  void add(std::span<btPersistentManifold* const> manifolds);
  /// Lays out all that was added. `bodies` of the movers; that of 0 is null.
  void build(std::span<btRigidBody* const> bodies);

  void warm_start(soft::Mover* movers);
  void solve(soft::Mover* movers, const soft::Substep& substep);
  void bounce(soft::Mover* movers);

  /// Writes the impulses into the manifolds, for the next step.
  void remember() const;

 private:
  struct Patch {
    btPersistentManifold* manifold;
    std::uint32_t a, b;
    std::array<std::int8_t, soft::kMostPoints> points;
    std::int8_t count, colour;
  };
  /// Blocks of one colour with as many points each.
  struct Run {
    std::size_t first, count;
    int points;
  };
  struct Stiffness {
    soft::Real rate_per_s, mass, impulse;
  };

  static Stiffness stiffness(soft::Real hertz, soft::Real h_s);
  void split(btPersistentManifold& manifold);
  void colour(Patch& patch);
  void sort();
  void fill(soft::Block& block, int lane, const Patch& patch, std::span<btRigidBody* const> bodies) const;

  soft::Kernel kernel_;
  Stiffness of_bodies_, of_statics_;
  std::vector<Patch> patches_, unsorted_;
  std::vector<std::uint64_t> used_;   ///< colours, by mover
  std::vector<std::uint32_t> place_;  ///< by patch: block * kLanes + lane
  std::vector<soft::Block> blocks_;
  std::vector<Run> runs_;
  bool bounces_ = false;  ///< any of them
};

}  // namespace aurasim::physics
