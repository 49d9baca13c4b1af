// The state of bodies: what the protocol looks at each step, and what a hand-off carries.
// World frame W: right-handed, z up, metres, seconds, kilograms, radians. B is a body's own frame.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/ids.h"

namespace aurasim::core {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

struct Pose {
  Vec3 p_WB = Vec3::Zero();
  Quat q_WB = Quat::Identity();
};

/// Returns X_AC.
inline Pose operator*(const Pose& X_AB, const Pose& X_BC) {
  return {X_AB.p_WB + X_AB.q_WB * X_BC.p_WB, (X_AB.q_WB * X_BC.q_WB).normalized()};
}

/// One body in one state, as the protocol sees it.
struct BodyState {
  BodyId id{};
  Epoch epoch = 0;
  PrototypeId prototype{};
  bool awake = true;
  /// First state in which the body exists. Later than the snapshot's step for a body that is announced and does not
  /// exist yet.
  Step birth = 0;
  Pose pose;
  Vec3 v_WB = Vec3::Zero();  ///< m/s
  Vec3 w_WB = Vec3::Zero();  ///< rad/s
  /// By how much an order that is due soon changes the velocity of the body's surface, m/s. Such a body counts as
  /// awake.
  double coming_kick_m_s = 0;
};

/// Two bodies of one node in contact or within Bullet's contact margin. Indices into Snapshot::bodies, a < b.
struct Contact {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};

/// The body with this id, or null if `bodies` has none. `bodies` is ascending by id.
inline const BodyState* find_body(const std::vector<BodyState>& bodies, BodyId id) {
  const auto place = std::ranges::lower_bound(bodies, id, {}, &BodyState::id);
  return place != bodies.end() && place->id == id ? &*place : nullptr;
}

/// All bodies of one node in state `step`, in ascending order of id. Its reader may keep what it has derived from the
/// snapshot before: most bodies of a large world sleep, and a reader then looks at those only that have changed.
struct Snapshot {
  Step step = 0;
  std::vector<BodyState> bodies;
  std::vector<Contact> contacts;  ///< between bodies, not with statics
  std::vector<Contact> joints;    ///< pairs of bodies held together by a joint
  std::size_t born = 0;           ///< number of bodies that exist already
  std::size_t awake = 0;          ///< number of those that are awake

  std::uint64_t number = 0;  ///< counts the snapshots of a world, from 1; 0: nothing is known of those before
  /// True if the snapshot before has the same bodies and joints, and differs only in what `changed` names.
  bool goes_on = false;
  std::vector<std::uint32_t> changed;     ///< indices of the bodies that may have changed; ascending
  std::vector<Contact> changed_contacts;  ///< contacts of those bodies; ascending

  /// True if `changed` names all differences from the snapshot of this number.
  bool goes_on_from(std::uint64_t earlier) const { return goes_on && earlier != 0 && number == earlier + 1; }
};

/// Indices of a block's columns along x and y (core/block.h).
struct Block {
  std::int32_t x = std::numeric_limits<std::int32_t>::min();  ///< not known yet, if it is this
  std::int32_t y = 0;

  bool is_known() const { return x != Block{}.x; }
  auto operator<=>(const Block&) const = default;
};

/// Full dynamic state of one body: all that a new host needs to compute the next state with the same bits. The rotation
/// is a matrix because that is what Bullet integrates; a quaternion would round it.
struct BodyRecord {
  BodyId id{};
  Epoch epoch = 0;
  PrototypeId prototype{};
  Step birth = 0;
  std::int32_t activation_state = 1;  ///< Bullet's: 1 active, 2 sleeping, 3 wants to sleep, 4 never sleeps, 5 disabled
  double deactivation_time = 0;       ///< how long it has been below the sleeping thresholds, s
  Vec3 p_WB = Vec3::Zero();
  Mat3 R_WB = Mat3::Identity();
  Vec3 v_WB = Vec3::Zero();
  Vec3 w_WB = Vec3::Zero();
  Block block = {};  ///< if it is not known, it is that of the centre
};

/// The body of a record as the protocol sees it. `awake` is true unless the body sleeps (2) or is disabled (5).
BodyState state_of(const BodyRecord& record);

/// Either end of a manifold: a body (>= 0, its id) or a static (< 0, -1 - its id).
using ObjectRef = std::int64_t;
constexpr ObjectRef ref_of(BodyId id) { return static_cast<ObjectRef>(value_of(id)); }
constexpr ObjectRef ref_of(StaticId id) { return -1 - static_cast<ObjectRef>(value_of(id)); }

/// One pair's contact cache. Its points are `point_count` rows of ClusterState::points from row `first_point` on.
struct ManifoldRecord {
  ObjectRef object0 = 0;  ///< Bullet's body0; the order matters
  ObjectRef object1 = 0;
  std::uint32_t first_point = 0;
  std::uint32_t point_count = 0;
};

/// Accumulated state of one joint: `value_count` entries of ClusterState::joint_values from `first_value` on.
struct JointRecord {
  JointId id{};
  std::uint32_t first_value = 0;
  std::uint32_t value_count = 0;
};

/// Number of doubles in one row of ClusterState::points; the columns are listed in physics/contact_cache.h.
inline constexpr std::size_t kContactPointDoubles = 41;

/// Bodies that move together, with everything that physics remembers about them.
struct ClusterState {
  std::vector<BodyRecord> bodies;         ///< ascending id
  std::vector<ManifoldRecord> manifolds;  ///< ascending (object0, object1)
  std::vector<double> points;             ///< rows of kContactPointDoubles
  std::vector<JointRecord> joints;
  std::vector<double> joint_values;
};

/// Removes the bodies for which unwanted(record) is true, and the manifolds of those bodies. Joint records stay,
/// because each of a joint's bodies has to know whether it is broken.
template <class Unwanted>
void remove_bodies(ClusterState& cluster, Unwanted&& unwanted) {
  std::vector<BodyId> gone;
  std::erase_if(cluster.bodies, [&](const BodyRecord& body) {
    if (!unwanted(body)) return false;
    gone.push_back(body.id);
    return true;
  });
  const auto is_gone = [&](ObjectRef ref) {
    return std::any_of(gone.begin(), gone.end(), [&](BodyId id) { return ref_of(id) == ref; });
  };
  std::erase_if(cluster.manifolds, [&](const ManifoldRecord& m) { return is_gone(m.object0) || is_gone(m.object1); });
}

}  // namespace aurasim::core
