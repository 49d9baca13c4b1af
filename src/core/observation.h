// The message of a node to one observer (core/interest.h) about one state. Observers only watch: nothing that they
// receive, or fail to receive, changes what is computed.
#pragma once

#include <cstdint>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"
#include "core/replica.h"

namespace aurasim::core {

/// Contact of two bodies, or of a body and a static, with an impulse while a state was computed.
struct ContactImpulse {
  ObjectRef a = 0;               ///< a body; if both are bodies, the one with the lower id
  ObjectRef b = 0;               ///< a body or a static
  Vec3 p_W = Vec3::Zero();       ///< mean of the contact points, weighted by their impulses
  Vec3 normal_W = Vec3::Zero();  ///< weighted mean normal from a to b, of length 1
  double impulse_Ns = 0;         ///< impulse along the normals, summed over the step; > 0
};

/// A joint with one coordinate (core/joint_motion.h).
struct JointState {
  JointId id{};
  double position = 0;  ///< rad or m, of a from b
  double speed = 0;     ///< rad/s or m/s
};

struct ObservedBody {
  /// If row.host is not the source, the body was handed over to that region. Its values are those of the observed state
  /// unless `stale` is set.
  ReplicaBody row;
  bool stale = false;  ///< row holds the earlier state in which the body left
};

/// One region's part of one state.
struct Observation {
  enum class Kind : std::uint8_t {
    kHosted = 0,  ///< wanted bodies that the source hosts, or has handed over and no other node has published since
    kMadeUp = 1   ///< an earlier state, which the source made up for bodies that joined late
  };

  RegionId source{};
  Generation generation = 0;
  std::uint32_t redo = 0;
  Step stamp = 0;
  std::uint64_t map_version = 0;
  std::uint64_t sequence = 1;  ///< sequence of the interest that it answers
  /// The state of the source's previous observation for this observer. It sends none of the states between, because the
  /// observer takes no more. -1: not stated.
  Step previous = -1;
  Kind kind = Kind::kHosted;
  std::uint64_t scene_order = 0;     ///< sequence of the newest order known to the source that changed the scene
  std::vector<ObservedBody> bodies;  ///< ascending id
  /// Bodies that were on their way lately, are known to the source now, and are not wanted. Ascending.
  std::vector<BodyId> outside;
  std::vector<JointState> joints;        ///< ascending id
  std::vector<ContactImpulse> contacts;  ///< ascending (a, b)
};

}  // namespace aurasim::core
