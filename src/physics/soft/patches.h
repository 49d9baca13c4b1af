// The contact points of awake bodies, as the soft step solves them: in patches, coloured so that those of a colour
// share no body that moves, side by side in blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "physics/soft/contacts.h"
#include "physics/soft/lanes.h"
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
  void add(SoftPatch& patch, std::uint32_t a, std::uint32_t b);
  /// Lays out all that was added. `inertias` as movers; gravity in m/s^2.
  void build(const soft::Mover* movers, const SoftInertia* inertias, const soft::Real (&gravity)[3], int threads);

  // By each worker, for its share. When they return, all have done theirs.
  void warm_start(soft::Mover* movers, const soft::Worker& worker);
  void solve(soft::Mover* movers, const soft::Substep& substep, const soft::Worker& worker);
  void bounce(soft::Mover* movers, const soft::Worker& worker);

  /// Writes the impulses into the manifolds, for the next step; into patches ahead of time, whether they have pressed.
  void remember(int threads) const;

 private:
  struct Entry {
    SoftPatch* patch;
    std::uint32_t a, b;   ///< movers
    std::uint32_t place;  ///< block * kLanes + lane
  };
  /// Blocks of one colour with as many points each.
  struct Run {
    std::size_t first, count;
    int points;
    bool in_order;  ///< they have no colour, and may share bodies
    bool ends;      ///< its colour
  };
  struct Stiffness {
    soft::Real rate_per_s, mass, impulse;
  };

  static Stiffness stiffness(double times, double step_s, int substeps);
  std::size_t place();
  /// work(blocks, count, points)
  template <class Work>
  void for_each_run(const soft::Worker& worker, Work&& work);
  void remember(const Entry& entry) const;
  void fill(soft::Block& block, int lane, const Entry& entry, const soft::Mover* movers, const SoftInertia* inertias,
            const soft::Real (&gravity)[3]) const;

  soft::Kernel kernel_;
  Stiffness of_bodies_, of_statics_;
  std::vector<Entry> entries_;       ///< as they came
  std::vector<std::uint64_t> used_;  ///< colours, by mover
  std::vector<soft::Block> blocks_;
  std::vector<Run> runs_;
  bool bounces_ = false;  ///< any of them
};

}  // namespace aurasim::physics
