// Simulates bodies in a Bullet world; records go in and out. Shared by the world of a region and the scratch world.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/body_state.h"
#include "core/changed_state.h"
#include "core/observation.h"
#include "core/scene.h"
#include "core/used_room.h"
#include "physics/body_table.h"
#include "physics/bounds.h"
#include "physics/bullet_convert.h"
#include "physics/contact_records.h"
#include "physics/coupling.h"
#include "physics/dynamics_world.h"
#include "physics/findings.h"
#include "physics/halo.h"
#include "physics/held_statics.h"
#include "physics/joint_table.h"
#include "physics/kept_hash.h"
#include "physics/moving_static.h"
#include "physics/results.h"
#include "physics/settings.h"
#include "physics/shapes.h"
#include "physics/state_notes.h"
#include "physics/timeline.h"
#include "physics/watched_bodies.h"

namespace aurasim::physics {

/// Functions with the same name as in RegionWorld mean the same.
class Simulation {
 public:
  /// `scene` and `timeline` have to outlive the simulation; both may grow.
  Simulation(const core::Scene& scene, const Settings& settings, std::shared_ptr<const ShapeSet> shapes,
             std::shared_ptr<const StaticPlaces> places, const Timeline& timeline);
  ~Simulation();

  core::Step step_number() const { return step_; }
  /// Sets the number of the present state. Only while there are no bodies.
  void start_at(core::Step step);

  void add(std::span<const core::BodyRecord> bodies);
  /// See RegionWorld::put_back(). Bodies, pairs and joints of both states stay in Bullet's world.
  void put_back(core::Step step, const core::ClusterState& then);
  /// Like add(), but with the contact cache and joints. The cluster has to be in state step_number().
  void join(const core::ClusterState& cluster);
  core::ClusterState release(std::span<const core::BodyId> bodies);
  std::vector<core::ClusterState> release(std::span<const std::span<const core::BodyId>> clusters);
  core::ClusterState peek(std::span<const core::BodyId> bodies) const;
  /// Like peek() of each cluster, but with contacts between its bodies and others.
  std::vector<core::ClusterState> copy_whole(std::span<const std::span<const core::BodyId>> clusters) const;
  /// Like peek() of all bodies, into `all`, whose memory is reused.
  void copy_all(core::ClusterState& all) const;
  /// The same. Where most bodies sleep, copies of successive states share what has not changed.
  void copy_all(core::ChangedState& copy);

  bool contains(core::BodyId id) const;
  std::size_t body_count() const;
  std::vector<core::BodyId> body_ids() const;

  void step();

  const core::Snapshot& snapshot();
  std::span<const core::BodyRecord> records();
  std::uint64_t hash_sum() { return hash_.sum(table_, notes_.for_hash); }
  const std::vector<Collision>& collisions() const { return collisions_; }
  std::uint64_t severed_contacts() const { return severed_contacts_; }
  /// See RegionWorld::couple().
  void couple(const Coupling& coupling);
  /// See RegionWorld::introductions_ahead().
  std::vector<core::Introduction> introductions_ahead();
  const std::vector<Moved>& arrived() const { return arrived_; }
  const std::vector<Moved>& left() const { return left_; }
  void watch_contacts(bool wanted) { world_.contact_impulses().want(wanted); }
  /// Contact impulses of the last step, if watched.
  const std::vector<core::ContactImpulse>& contact_impulses() const { return contact_impulses_; }

  std::vector<Removal> take_removed() { return std::exchange(removed_, {}); }
  std::vector<std::uint64_t> take_applied() { return std::exchange(applied_, {}); }
  std::vector<Declined> take_declined() { return std::exchange(declined_, {}); }
  std::uint64_t take_unbearable() { return std::exchange(unbearable_, 0); }
  /// See RegionWorld::new_setpoints().
  const std::vector<core::BodySetpoint>& new_setpoints() const { return new_setpoints_; }

  /// The nearest body or static on the segment from `from_W` to `to_W`.
  RayHit cast(const core::Vec3& from_W, const core::Vec3& to_W) const;
  /// Number of statics that are held (held_statics.h).
  std::size_t held_statics() const { return statics_.held_count(); }

 private:
  void insert_born();
  void settle_blocks();
  void bind_mechanisms();
  void apply_orders(core::Step n);
  void kick(btRigidBody& body, const core::Order& order);
  void take_out(const Removal& removal);
  void take_out_what_broke();
  void wake_beside(core::BodyId id);
  // Coupled regions:
  void meet_neighbours();
  std::vector<core::ClusterState> send_halos(std::vector<Visit>& guests);
  bool is_to_be_watched(const HostedBody& body) const;
  void meet_far();
  void find_seams();
  bool may_be_in_chains(const HostedBody& body, double way_m) const;
  void find_reached(const HostedBody& body, double way_m, std::vector<core::RegionId>& reached) const;
  void check_partners(const Bounds& reach) const;
  void post(core::RegionId to, const Halo& halo);
  Halo fetch(core::RegionId from);
  Bounds reach_of(const btRigidBody& body) const;
  Bounds around_reach_of(const btRigidBody& body) const;
  Visit visit_of(const HostedBody& body) const;
  core::RegionId host_of(const HostedBody& body) const;
  std::vector<core::ClusterState> hand_over(std::span<const std::span<const core::BodyId>> clusters);
  void take_over(const core::ClusterState& cluster, std::span<const Visit> visits);
  void push(btRigidBody& body, const Visit& visit);
  void take_guests(std::vector<Visit>& visits);
  void part_from(core::BodyId id);
  void restore_later(const core::ClusterState& cluster, std::span<const std::uint32_t> records);
  void restore_late_contacts();
  void send_home(std::span<const core::BodyId> guests_before);
  void find_shown();
  std::uint32_t shown_at(std::size_t place) const {
    return shown_at_.empty() ? static_cast<std::uint32_t>(place) : shown_at_[place];
  }
  void leave_out_guests(std::vector<core::Contact>& pairs) const;
  bool is_for_us_to_copy(const ContactView& contact) const;
  void drop_guests(std::span<const core::BodyId> ids);
  void show_statics(core::Step n);
  void wake_near(std::span<const Bounds> changing);
  struct MovingStatic;
  core::Pose pose_of(const MovingStatic& moving, core::Step n) const;
  void make_moving(std::uint32_t index, bool goes);
  void note_moving_statics();
  void place_moving_statics();
  void start_moving_statics();
  /// A push that a moving static may give.
  struct Shove {
    Bounds where;
    double speed_m_s;
  };
  std::vector<Shove> coming_shoves() const;
  double coming_shove(const HostedBody& body, std::span<const Shove> shoves) const;
  void find_near(std::span<const Bounds> places);
  void note_near(const Bounds& where);
  double coming_kick(const HostedBody& body, std::span<const std::uint32_t> coming_statics) const;
  void heed_setpoints(core::Step n);
  bool heed(btRigidBody& body, core::Quantity quantity, const core::Vec3& value);
  void push();
  void stop_pushing();
  /// By how much setpoints will change the velocity of the surface of the body at `place`, m/s.
  struct PlacedPush {
    std::size_t place;
    double change_m_s;
  };
  std::vector<PlacedPush> coming_pushes() const;
  double kick_ahead(const HostedBody& body, std::size_t place, std::span<const std::uint32_t> coming_statics,
                    std::span<const PlacedPush> pushes, std::span<const Shove> shoves) const;
  /// Bounding radius of a body's shape, m. Expensive for hulls: all points are searched.
  double bounding_radius(const HostedBody& body) const;
  /// Number of states for which other nodes act upon the auras of the present state.
  core::Step foreseen() const { return static_cast<core::Step>(std::ceil(settings_.foresight_s / settings_.step_s)); }
  void put_in(std::span<const core::BodyRecord> bodies);
  void insert(std::vector<HostedBody> arrivals);
  HostedBody make_body(const core::BodyRecord& record);
  void set_motion(btRigidBody& rigid, const core::BodyRecord& record);
  std::vector<core::BodyRecord> take_out_all_but(std::span<const core::BodyRecord> bodies, core::Step step);
  int rank_of(core::BodyId id) const;
  btRigidBody* find_object(core::ObjectRef ref);
  btRigidBody* bring_object(core::ObjectRef ref);
  core::ObjectRef ref_of(const btCollisionObject& object) const;
  void restore_contacts(const core::ClusterState& cluster);
  void restore_pair(const core::ClusterState& cluster, std::span<const std::uint32_t> records);
  /// A body of a cluster that is to be copied.
  struct Member {
    std::uint32_t place;    ///< in the table
    std::uint32_t cluster;  ///< its number
  };
  std::vector<Member> membership(std::span<const std::span<const core::BodyId>> clusters) const;
  struct Copies;
  Copies copy(std::span<const Member> members, std::size_t count, bool whole) const;
  void collect_collisions();
  void collect_contact_impulses();
  void list_contacts();
  void list_changed_contacts();
  bool regroup_snapshot();
  bool list_contacts_of_arrivals();
  void forget_moved();
  void show_state(const HostedBody& body, std::size_t place, double coming_kick_m_s);
  void count(const core::BodyState& state, std::int64_t times);
  void erase(std::span<const std::uint32_t> leaving);
  void copy_changes(core::ChangedState& copy);
  void note_moved();
  void free_spare_memory();
  void sort_places(std::vector<std::uint32_t>& places);
  void note(core::BodyId id);
  void note_new(core::BodyId id);
  void note_all();

  const core::Scene* scene_;
  Settings settings_;
  std::shared_ptr<const ShapeSet> shapes_;
  const Timeline& timeline_;
  HeldStatics statics_;
  struct MovingStatic {
    std::uint32_t index;
    core::StaticBody body;
    std::unique_ptr<Belt> belt;
    bool goes = false;  ///< it moves or has moved; false: it only has a belt
  };
  std::vector<MovingStatic> moving_statics_;  ///< ascending index
  BodyTable table_;
  JointTable joints_;
  DynamicsWorld world_;

  core::Step step_ = 0;
  std::uint64_t severed_contacts_ = 0;
  std::vector<Collision> collisions_;
  std::vector<core::ContactImpulse> contact_impulses_;
  std::vector<Removal> removed_;
  std::vector<std::uint64_t> applied_;
  std::vector<Declined> declined_;
  struct Push {
    btRigidBody* body;
    btVector3 force, torque;  ///< N, N m
  };
  std::vector<Push> pushed_;      ///< bodies with forces in the state that is being computed
  std::uint64_t unbearable_ = 0;  ///< number of setpoints not applied
  std::vector<core::BodySetpoint> new_setpoints_;

  std::shared_ptr<const core::ClusterState> shared_copy_;
  std::vector<ContactView> found_contacts_;
  std::unique_ptr<Coupling> coupling_;  ///< null: this world is not coupled with others
  std::vector<core::BodyId> broken_;    ///< bodies that broke down in the present state
  WatchedBodies watched_;
  /// A body that this region hosts, and what it may touch in the step.
  struct AtBorder {
    core::BodyId id;
    Bounds reach;
  };
  std::vector<AtBorder> at_border_;   ///< bodies outside of the interior that this region has kept at the last meeting
  std::vector<core::BodyId> guests_;  ///< of the last meeting
  std::uint64_t meeting_ = 0;         ///< number of the last meet_neighbours()
  ParcelWriter parcel_;
  std::vector<Moved> arrived_, left_;
  core::ClusterState late_contacts_;  ///< contacts with bodies of other regions that are not here yet

  mutable std::vector<KeyedContact> copied_contacts_;  ///< of copy_all(), kept for its memory
  StateNotes notes_;
  Findings findings_;  ///< about the bodies of notes_.for_step
  KeptHash hash_;
  bool will_stop_sleepers_ = false;   ///< the next step may change sleepers
  std::vector<core::BodyId> unborn_;  ///< all bodies that are not born yet, and perhaps some that have left
  core::Step next_birth_ = 0;         ///< no body is born before
  int steps_since_snapshot_ = 0;
  std::vector<std::uint32_t> moved_;           ///< places of the bodies that the last step has moved
  std::vector<core::BodyId> moved_ids_;        ///< scratch: their ids
  std::vector<core::Contact> moved_contacts_;  ///< their contacts, in no order
  std::size_t moved_count_ = 0;                ///< of bodies that the last step has moved
  core::UsedRoom used_room_;                   ///< of lists with an item for each of these bodies
  std::vector<std::pair<int, int>> touched_;   ///< pairs in contact of them, by user index
  std::vector<core::BodyId> kicked_;           ///< bodies of the snapshot with a coming kick, or not yet born
  bool snapshot_is_fresh_ = false;
  core::Snapshot snapshot_;
  /// By place in the table: place in the snapshot, which has no guests. Empty where regions are not coupled.
  std::vector<std::uint32_t> shown_at_;
  std::uint32_t shown_ = 0;  ///< number of bodies that the snapshot is to have
  bool records_are_fresh_ = false;
  std::vector<core::BodyRecord> records_;
  std::vector<core::Contact> unsorted_contacts_;
  std::vector<std::uint32_t> contacts_before_;  ///< by body: number of contacts of all bodies before it
  std::vector<std::uint32_t> near_;             ///< of find_near()
  std::vector<std::uint8_t> is_moved_;          ///< by body: it is among moved_; all 0 between two calls
  std::vector<PartManifold> of_pair_;
};

}  // namespace aurasim::physics
