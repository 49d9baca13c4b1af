// What a node publishes for observers (core/replica.h): at each tick what has changed since the last one, and key
// frames with everything. Knows neither clock nor wire.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <unordered_map>
#include <vector>

#include "core/messages.h"
#include "core/replica.h"
#include "node/node.h"

namespace aurasim::node {

/// Steps between two ticks. Every node publishes the states whose number is a multiple of it, so an observer can put
/// states of all regions together.
core::Step tick_steps(double step_hz, double tick_hz);

class ReplicaFeed {
 public:
  ReplicaFeed(core::RegionId self, core::Generation generation, std::uint64_t map_version);

  /// After every step while somebody listens: who has left since the last tick.
  void note(const StepReport& report);

  /// What has changed since the last tick, for a tick at `snapshot`, which is the state after the departures of its
  /// step. Valid until the next call.
  const core::Replica& compose_changes(const core::Snapshot& snapshot);

  /// Everything: the bodies of the same state, and those on their way from here. After compose_changes. Valid until the
  /// next call.
  const core::Replica& compose_key_frame(const core::Snapshot& snapshot, const std::deque<core::HandOff>& under_way);

  /// Something was published since the last key frame.
  bool changed_since_key_frame() const { return changed_since_key_frame_; }

  /// Nobody listens any more: whoever comes next gets everything anew.
  void forget();

 private:
  struct Published {
    core::Epoch epoch = 0;
    bool asleep = false;
    core::Vec3 p_WB;
    Eigen::Quaternionf q_WB;
  };
  bool is_news(const core::BodyState& body) const;
  void compose_departures();
  void compose_removals(const core::Snapshot& snapshot);
  void begin(core::Replica& replica, core::Step stamp, bool key_frame) const;

  core::RegionId self_;
  core::Generation generation_;
  std::uint64_t map_version_;
  std::uint64_t sequence_ = 0;
  std::unordered_map<core::BodyId, Published> published_;
  struct Left {
    core::ReplicaBody row;  ///< under the new epoch
    core::Step birth = 0;   ///< published from then on
  };
  std::map<core::BodyId, Left> left_;  ///< since the last tick
  core::Replica changes_;
  core::Replica all_;
  bool changed_since_key_frame_ = false;
};

}  // namespace aurasim::node
