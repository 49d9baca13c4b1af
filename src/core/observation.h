// What a node tells one observer (core/interest.h) of one state. Observers only watch: nothing that they receive, or do
// not, changes what is computed.
#pragma once

#include <cstdint>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"
#include "core/replica.h"

namespace aurasim::core {

/// Two bodies, or a body and a static, that have pressed on each other while a state was computed.
struct ContactImpulse {
  ObjectRef a = 0;               ///< body; of two bodies the one with the lower id
  ObjectRef b = 0;               ///< body or static
  Vec3 p_W = Vec3::Zero();       ///< mean of the contact points, by their impulses
  Vec3 normal_W = Vec3::Zero();  ///< from a to b, likewise; of length 1
  double impulse_Ns = 0;         ///< along the normals, summed up over the step; > 0
};

/// A joint with one coordinate (core/joint_motion.h).
struct JointState {
  JointId id{};
  double position = 0;  ///< rad or m, of a from b
  double speed = 0;     ///< rad/s or m/s
};

struct ObservedBody {
  /// Its host is another region than the source: handed over to that one, and exactly so if `stale` is not set.
  ReplicaBody row;
  bool stale = false;  ///< of the state in which it left, which is an earlier one
};

/// What one region has of one state.
struct Observation {
  enum class Kind : std::uint8_t {
    kHosted = 0,  ///< all that is wanted of what it hosts, or has handed over and nobody has published since
    kMadeUp = 1   ///< of an earlier state, which it has made up for bodies that have joined late
  };

  RegionId source{};
  Generation generation = 0;
  std::uint32_t redo = 0;
  Step stamp = 0;
  std::uint64_t map_version = 0;
  std::uint64_t sequence = 1;  ///< of the interest that it answers
  /// The state that the source has told this observer before. It tells none of those between the two, because the
  /// observer takes no more; -1: not said.
  Step previous = -1;
  Kind kind = Kind::kHosted;
  std::uint64_t scene_order = 0;  ///< sequence of the newest order that has changed the scene, as far as source knows
  std::vector<ObservedBody> bodies;  ///< ascending id
  /// Bodies that were on their way lately, are accounted for here, and are not wanted. Ascending.
  std::vector<BodyId> outside;
  std::vector<JointState> joints;        ///< ascending id
  std::vector<ContactImpulse> contacts;  ///< ascending (a, b)
};

}  // namespace aurasim::core
