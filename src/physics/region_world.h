// One region's Bullet world. The same bodies take the same path to the last bit, whichever worlds host them on the way
// (docs/design.md, "The same bits"). No Bullet header is needed to use it: single and double precision are two
// libraries behind this header.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/body_state.h"
#include "core/changed_state.h"
#include "core/control_log.h"
#include "core/ids.h"
#include "core/introduction.h"
#include "core/order.h"
#include "core/scene.h"
#include "core/static_moves.h"
#include "physics/coupling.h"
#include "physics/results.h"
#include "physics/settings.h"

namespace aurasim::physics {

/// A body that arrives more than this many states after an order does not execute it.
inline constexpr core::Step kOrderMemory = 3600;

class RegionWorld {
 public:
  /// The scene has to outlive the world; its shapes, prototypes and statics may grow. The world begins with the statics
  /// and without bodies: the caller adds those that this node hosts.
  RegionWorld(const core::Scene& scene, const Settings& settings);
  ~RegionWorld();
  RegionWorld(RegionWorld&&) noexcept;
  RegionWorld& operator=(RegionWorld&&) noexcept;

  /// Number of the state that the bodies are in; 0 at first.
  core::Step step_number() const;

  /// Adds bodies without contact cache. A record whose birth is later than step_number() waits outside Bullet until
  /// that state is computed; snapshots and releases include it, with its state at birth. Throws std::invalid_argument,
  /// with nothing done, if one of them is here already or its id is too large for Bullet's broadphase (an int, less the
  /// number of statics).
  void add(std::span<const core::BodyRecord> bodies);

  /// Adds a cluster in state `stamp` <= step_number(). It is first simulated up to step_number() in a scratch world,
  /// then joins with its contact cache. Calls `caught_up` for every state made up.
  void adopt(const core::ClusterState& cluster, core::Step stamp, const CatchUpListener& caught_up = {});

  /// Computes the states of a cluster after `stamp` up to step_number(), as adopt() would make them up, and leaves this
  /// world as it is. Returns the contact impulses in these states, if they are watched.
  std::vector<MadeUpContacts> foresee(const core::ClusterState& cluster, core::Step stamp,
                                      const CatchUpListener& caught_up);

  /// Removes bodies and returns everything that a hand-off has to carry. Every id must be here, or
  /// std::invalid_argument is thrown with nothing done. Contacts and joints with bodies that stay behind are dropped
  /// and counted (see severed_contacts()).
  core::ClusterState release(std::span<const core::BodyId> bodies);
  /// Like release(bodies), for several clusters at once. No body may be in two of them.
  std::vector<core::ClusterState> release(std::span<const std::span<const core::BodyId>> clusters);

  /// The record that release() would return, of bodies that stay (tests, key frames, state hash).
  core::ClusterState peek(std::span<const core::BodyId> bodies) const;

  /// Like peek(), with the contacts between these bodies and others.
  core::ClusterState peek_whole(std::span<const core::BodyId> bodies) const;

  /// The record of all bodies, including those not yet born.
  core::ClusterState peek_all() const;
  /// Like peek_all(), into `all`, whose memory is reused.
  void copy_all(core::ClusterState& all) const;
  /// The same. Where most bodies sleep, copies of successive states share what has not changed.
  void copy_all(core::ChangedState& copy);
  /// Goes back to an earlier state, in which `bodies` are all bodies of this world. Orders are executed again when they
  /// are due.
  void put_back(core::Step step, const core::ClusterState& bodies);

  /// Schedules an order for its state, also for bodies that arrive late. Precondition: orders that define shapes,
  /// prototypes or statics have been applied to the scene. Throws std::invalid_argument for shapes that Bullet cannot
  /// use. For a MoveStatic, returns the first state that it changes (core::StaticMoves::add).
  std::optional<core::Step> schedule(const core::Order& order);
  /// Moves of statics by orders and programs.
  const core::StaticMoves& moves() const;
  core::StaticMoves& moves();
  /// Events since the last call: bodies removed by orders or because they broke down; requests that bodies here
  /// executed, and requests that they declined.
  std::vector<Removal> take_removed();
  std::vector<std::uint64_t> take_applied();
  std::vector<Declined> take_declined();
  /// Number of setpoints since the last call that were not applied, because they would have made a body here too fast.
  std::uint64_t take_unbearable();
  /// Setpoints of bodies here that took effect or ended in the last step. Ascending (id, quantity).
  const std::vector<core::BodySetpoint>& new_setpoints() const;

  /// Setpoints of all bodies and joints, hosted here or elsewhere.
  core::ControlLog& controls();
  const core::ControlLog& controls() const;

  /// The nearest body or static on the segment between two points, in the present state.
  RayHit cast(const core::Vec3& from_W, const core::Vec3& to_W) const;

  /// Number of statics that this world holds at present: those near its bodies, and those that are large or move.
  std::size_t held_statics() const;

  bool contains(core::BodyId id) const;
  std::size_t body_count() const;

  /// Computes the next state, in Settings::substeps substeps.
  void step();

  /// Bodies ascending by id (those not yet born included), contacts and joints between bodies. Valid until the next
  /// change.
  const core::Snapshot& snapshot();

  /// Records of all born bodies in ascending order of id. Valid until the next change.
  std::span<const core::BodyRecord> records();

  /// The sum of the state hashes (state_hash.h) of all born bodies, modulo 2^64.
  std::uint64_t hash_sum();

  /// First contacts found while the last step was computed, and those of clusters that have caught up since the step
  /// before (with an earlier `step`). Ordered by (a, b, step).
  const std::vector<Collision>& collisions() const;

  /// Couples this world with those of other regions: from the next step on, each body is hosted by the owner of its
  /// block, and step() exchanges parcels with the other regions, which have to step, too. Only while there are no
  /// bodies. Throws std::invalid_argument for a solver other than the soft step. step() then also throws BadParcel
  /// (physics/parcel.h).
  void couple(const Coupling& coupling);
  /// Where regions are coupled: the pairs of regions for core::SeamPartners that the next step needs because of bodies
  /// that are hosted here. Ascending. Orders and setpoints of the next step change nothing about it.
  std::vector<core::Introduction> introductions_ahead();
  /// Bodies that came in the last step, and bodies that left in it. Ascending by id. Those that came have their new
  /// epochs.
  const std::vector<Moved>& arrived() const;
  const std::vector<Moved>& left() const;

  /// Switches the sums of contact impulses on or off, from the next step on. It changes no bit of the simulation.
  void watch_contacts(bool wanted);
  /// Contact impulses of the last step, if it was watched. Includes bodies that have left since, not bodies that sleep.
  /// Ascending (a, b).
  const std::vector<core::ContactImpulse>& contact_impulses() const;
  /// Contact impulses in the states made up for late clusters since the last call.
  std::vector<MadeUpContacts> take_made_up_contacts();

  /// Contacts and joints that release() has dropped so far. Stays 0 as long as whole clusters are released.
  std::uint64_t severed_contacts() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::physics
