// One region's Bullet world, set up so that the same bodies take the same path, to the last bit, whichever worlds
// they visit on the way (docs/design.md, "The same bits"). No Bullet header is needed to use it: the two precisions are
// two libraries behind this one header.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/body_state.h"
#include "core/control_log.h"
#include "core/ids.h"
#include "core/order.h"
#include "core/scene.h"
#include "core/static_moves.h"
#include "physics/results.h"
#include "physics/settings.h"

namespace aurasim::physics {

/// A body that arrives later than this many states after an order does not apply it.
inline constexpr core::Step kOrderMemory = 3600;

class RegionWorld {
 public:
  /// The scene outlives the world; its shapes, prototypes and statics may grow. Statics are put in, the scene's bodies
  /// are not: the caller says who is hosted.
  RegionWorld(const core::Scene& scene, const Settings& settings);
  ~RegionWorld();
  RegionWorld(RegionWorld&&) noexcept;
  RegionWorld& operator=(RegionWorld&&) noexcept;

  /// The state that the bodies are in; 0 at first.
  core::Step step_number() const;

  /// Puts in bodies without contact cache. A record whose birth is later than step_number() waits outside Bullet
  /// until that state is computed; snapshots and releases include it, with its state at birth.
  /// Throws std::invalid_argument, with nothing done, if one of them is here already or its id is too large for
  /// Bullet's broadphase (an int, less the number of statics).
  void add(std::span<const core::BodyRecord> bodies);

  /// Takes over a cluster whose state is that of step `stamp` <= step_number(): it is first simulated up to
  /// step_number() in a scratch world, then joins with its contact cache. Calls `caught_up` for every state made up.
  void adopt(const core::ClusterState& cluster, core::Step stamp, const CatchUpListener& caught_up = {});

  /// Computes the states of a cluster after `stamp` up to step_number(), as adopt() would make them up, and leaves this
  /// world as it is. Returns what has pressed on what in them, if that is watched.
  std::vector<MadeUpContacts> foresee(const core::ClusterState& cluster, core::Step stamp,
                                      const CatchUpListener& caught_up);

  /// Takes bodies out with everything that a hand-off has to carry. Every id must be here, or std::invalid_argument
  /// is thrown with nothing done. Contacts and joints with bodies that stay behind are cut and counted (see
  /// severed_contacts).
  core::ClusterState release(std::span<const core::BodyId> bodies);
  /// Several clusters in one go. No body may be in two of them.
  std::vector<core::ClusterState> release(std::span<const std::span<const core::BodyId>> clusters);

  /// The same record of bodies that stay (tests, key frames, state hash).
  core::ClusterState peek(std::span<const core::BodyId> bodies) const;

  /// All bodies, those that wait for their birth included, as release() would give them.
  core::ClusterState peek_all() const;
  /// Goes back to an earlier state: `bodies` are all that are here then. Orders are applied again when they are due.
  void put_back(core::Step step, const core::ClusterState& bodies);

  /// An order to apply in time, also by bodies that arrive late. Orders that define shapes, prototypes or statics have
  /// changed the scene before. Throws std::invalid_argument for shapes that Bullet cannot use. Of a static that is to
  /// move: returns the first state that is another one by it (core::StaticMoves::add).
  std::optional<core::Step> schedule(const core::Order& order);
  /// Of statics that orders and programs have told to move.
  const core::StaticMoves& moves() const;
  core::StaticMoves& moves();
  /// Since the last call: bodies taken out, by orders or because no world can bear them; requests that were
  /// applied to bodies here, and those that were not.
  std::vector<Removal> take_removed();
  std::vector<std::uint64_t> take_applied();
  std::vector<Declined> take_declined();
  /// Since the last call: setpoints that would have made a body here faster than may be, and were not obeyed.
  std::uint64_t take_unbearable();
  /// Those that began to be in effect in the last step on bodies that were here, or were let go of in it. Ascending
  /// (id, quantity).
  const std::vector<core::BodySetpoint>& new_setpoints() const;

  /// What programs want of bodies, here or elsewhere.
  core::ControlLog& controls();
  const core::ControlLog& controls() const;

  /// The nearest body or static between two points, in the present state.
  RayHit cast(const core::Vec3& from_W, const core::Vec3& to_W) const;

  bool contains(core::BodyId id) const;
  std::size_t body_count() const;

  /// Computes the next state, in Settings::substeps substeps.
  void step();

  /// Bodies ascending by id (those not yet born included), contacts and joints between bodies. Valid until the next
  /// change.
  const core::Snapshot& snapshot();

  /// Records of all born bodies in ascending order of id. Valid until the next change.
  std::span<const core::BodyRecord> records();

  /// First contacts seen while the last step was computed, and those of clusters that have caught up since the step
  /// before (their `step` is earlier). Ordered by (a, b, step).
  const std::vector<Collision>& collisions() const;

  /// Whether what presses on what is summed up in the steps from now on. It changes no bit.
  void watch_contacts(bool wanted);
  /// Of the last step, if it was watched: of bodies that were here, those that have left since included. Ascending (a,
  /// b). Of bodies that sleep, none.
  const std::vector<core::ContactImpulse>& contact_impulses() const;
  /// Likewise in the states that were made up for late clusters since the last call.
  std::vector<MadeUpContacts> take_made_up_contacts();

  /// Contacts and joints that a release has cut so far: never more than 0 while clusters are whole.
  std::uint64_t severed_contacts() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::physics
