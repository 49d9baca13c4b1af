// The contact points of awake bodies, as the soft step solves them: in patches, coloured so that those of a colour
// share no body that moves, side by side in blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "physics/soft/contacts.h"
#include "physics/soft/lanes.h"
#include "physics/soft/layout.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {

/// What resists, in the world frame.
struct SoftInertia {
  soft::Real inv_mass = 0;         ///< 1/kg
  soft::Real inv_inertia[6] = {};  ///< xx, xy, xz, yy, yz, zz, 1/(kg m^2)
};

class SoftPatches {
 public:
  SoftPatches(double step_s, int substeps);

  void clear(std::size_t movers);
  /// Of bodies with these movers. The patches of an island come in an order that follows from the island alone: so do
  /// the colours.
  void add(SoftPatch& patch, std::int32_t a, std::int32_t b);
  /// Lays out all that was added. `inertias` of bodies, as movers; gravity in m/s^2.
  void build(const soft::Mover* movers, const SoftInertia* inertias, const soft::Real (&gravity)[3], int threads);

  // By each worker, for its share. When they return, all have done theirs.
  void warm_start(soft::Mover* movers, const soft::Worker& worker);
  void solve(soft::Mover* movers, const soft::Substep& substep, const soft::Worker& worker);
  void bounce(soft::Mover* movers, const soft::Worker& worker);

  // What has pressed in all substeps, if that is wanted. Touches nothing that is computed.
  /// After build().
  void begin_tally(bool wanted);
  /// By each worker, for its share, after each substep; of the last one after bounce().
  void tally(const soft::Worker& worker);
  std::size_t size() const { return patches_.size(); }
  const SoftPatch& patch(std::size_t i) const { return *patches_[i]; }
  std::int32_t mover_a(std::size_t i) const { return layout_.a(i); }
  std::int32_t mover_b(std::size_t i) const { return layout_.b(i); }
  /// Of a patch's point, N s.
  soft::Real tallied(std::size_t i, int point) const;

  /// Writes the impulses into the manifolds, for the next step; into patches ahead of time, whether they have pressed.
  void remember(int threads) const;

 private:
  /// A spring and a damper that cannot overshoot in a substep, as a share of a rigid contact's impulse.
  struct Stiffness {
    Stiffness(soft::Real hertz, soft::Real substep_s);
    soft::Real rate_per_s, mass, impulse;
  };

  struct alignas(64) Sums {
    soft::Lanes of[soft::kMostPoints];  ///< N s
  };

  soft::Real load(const SoftPatch& patch, soft::Real inv_mass, soft::Real gravity) const;
  void remember(std::size_t i) const;
  void fill(std::size_t at, const soft::Mover* movers, const SoftInertia* inertias, const soft::Real (&gravity)[3]);

  soft::Real substep_s_;
  soft::Real light_hertz_, heavy_hertz_;  ///< of springs between bodies
  std::vector<SoftPatch*> patches_;       ///< as they came
  SoftLayout layout_;                     ///< by the number of points
  std::vector<soft::Block> blocks_;
  bool tallies_ = false;
  std::vector<Sums> sums_;  ///< by block
  bool bounces_ = false;    ///< any of them
};

}  // namespace aurasim::physics
