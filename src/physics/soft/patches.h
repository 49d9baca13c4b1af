// The contact points of awake bodies, as the soft step solves them: in patches, side by side in blocks. Patches of one
// colour share no body that moves (soft/layout.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "physics/soft/contacts.h"
#include "physics/soft/lanes.h"
#include "physics/soft/layout.h"
#include "physics/soft/threads.h"

class btRigidBody;

namespace aurasim::physics {

class SoftExchange;

/// Inverse mass and inertia of a body, in the world frame.
struct SoftInertia {
  soft::Real inv_mass = 0;         ///< 1/kg
  soft::Real inv_inertia[6] = {};  ///< xx, xy, xz, yy, yz, zz, 1/(kg m^2)
};

SoftInertia inertia_of(const btRigidBody& body);

class SoftPatches {
 public:
  SoftPatches(double step_s, int substeps);

  void clear(std::size_t movers, std::size_t patches);
  /// Sets the i-th patch, between two movers. The patches of an island have to come in an order that follows from the
  /// island alone. `group`: as in SoftLayout::put(). Several threads may set different patches.
  void put(std::size_t i, SoftPatch& patch, std::int32_t a, std::int32_t b, SoftPhase phase, std::size_t group);
  /// Lays out all patches. `inertias`: by mover; gravity in m/s^2.
  void build(const soft::Mover* movers, const SoftInertia* inertias, const soft::Real (&gravity)[3], soft::Team& team);

  // The next three are called by each worker for its share. They return when all workers are done.
  void warm_start(soft::Mover* movers, const soft::Worker& worker);
  // `shared`: with other regions; null if there are none.
  void solve(soft::Mover* movers, const soft::Substep& substep, SoftExchange* shared, const soft::Worker& worker);
  void bounce(soft::Mover* movers, SoftExchange* shared, const soft::Worker& worker);

  // Sums of the contact impulses over all substeps, for observers. They change nothing that is computed.
  /// Clears the sums, or switches them off. Call after build().
  void begin_tally(bool wanted);
  /// Adds the impulses of a substep. Called by each worker for its share after each substep, after the last one's
  /// bounce().
  void tally(const soft::Worker& worker);
  std::size_t size() const { return patches_.size(); }
  const SoftLoad& load() const { return layout_.load(); }
  /// After build(): can bounce() change the i-th patch?
  bool may_bounce(std::size_t i) const;
  const SoftPatch& patch(std::size_t i) const { return *patches_[i]; }
  std::int32_t mover_a(std::size_t i) const { return layout_.a(i); }
  std::int32_t mover_b(std::size_t i) const { return layout_.b(i); }
  /// Sum of a patch's point, N s.
  soft::Real tallied(std::size_t i, int point) const;

  /// Writes the impulses into the manifolds for the next step. In patches ahead of time, notes whether they have
  /// pressed.
  void remember(soft::Team& team) const;

 private:
  /// A spring with damper that cannot overshoot in a substep, as shares of a rigid contact's impulse.
  struct Stiffness {
    Stiffness(soft::Real hertz, soft::Real substep_s);
    soft::Real rate_per_s, mass, impulse;
  };

  struct alignas(64) Sums {
    soft::Lanes of[soft::kMostPoints];  ///< N s
  };

  soft::Real load(const SoftPatch& patch, soft::Real inv_mass, soft::Real gravity) const;
  static void prefetch_impulses(const SoftPatch& patch);
  void remember(std::size_t i) const;
  void fill(std::size_t at, const soft::Mover* movers, const SoftInertia* inertias, const soft::Real (&gravity)[3]);

  soft::Real step_s_, substep_s_;
  soft::Real rest_m_s_ = 0;               ///< points that approach more slowly do not bounce
  soft::Real light_hertz_, heavy_hertz_;  ///< frequencies of the springs between bodies, by load
  std::vector<SoftPatch*> patches_;
  SoftLayout layout_{SoftLayout::Waits::kInEachPhase};  ///< the kind is the number of points
  std::vector<soft::Block> blocks_;
  bool tallies_ = false;
  std::vector<Sums> sums_;                ///< by block
  std::vector<std::uint8_t> may_bounce_;  ///< by block: bounce() can change some patch of it
  std::vector<std::uint8_t> bounces_;     ///< by thread: some patch of its share may bounce
};

}  // namespace aurasim::physics
