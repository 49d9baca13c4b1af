// Messages of a node for observers: which bodies it hosts, where they are, and where those that left went. Observers
// only watch: nothing that they receive, or fail to receive, changes what is computed.
#pragma once

#include <cstdint>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::core {

/// State of one body, published by its host, or by the host that has just handed it over.
struct ReplicaBody {
  BodyId id{};
  Epoch epoch = 0;
  RegionId host{};  ///< if not the source: handed over to that region under this epoch, and perhaps still on its way
  PrototypeId prototype{};
  bool asleep = false;
  Vec3 p_WB = Vec3::Zero();
  Eigen::Quaternionf q_WB = Eigen::Quaternionf::Identity();
  Eigen::Vector3f v_WB = Eigen::Vector3f::Zero();  ///< m/s
  Eigen::Vector3f w_WB = Eigen::Vector3f::Zero();  ///< rad/s
};

/// The row of `body`. `host`: the region that hosts it.
inline ReplicaBody replica_body(const BodyState& body, RegionId host) {
  return {.id = body.id,
          .epoch = body.epoch,
          .host = host,
          .prototype = body.prototype,
          .asleep = !body.awake,
          .p_WB = body.pose.p_WB,
          .q_WB = body.pose.q_WB.cast<float>(),
          .v_WB = body.v_WB.cast<float>(),
          .w_WB = body.w_WB.cast<float>()};
}

/// A body that its host no longer has. A row with a higher epoch overrides it.
struct RemovedBody {
  BodyId id{};
  Epoch epoch = 0;
};

/// The changes at one source since its last tick, or, in a key frame, all bodies of the source.
struct Replica {
  RegionId source{};
  Generation generation = 0;
  Step stamp = 0;
  std::uint64_t map_version = 0;
  /// Number of the tick within the generation, from 1. A gap means a lost tick. A key frame has the number of the tick
  /// with which it was published.
  std::uint64_t sequence = 0;
  bool key_frame = false;
  std::vector<ReplicaBody> bodies;  ///< ascending id
  std::vector<RemovedBody> removed;
};

}  // namespace aurasim::core
