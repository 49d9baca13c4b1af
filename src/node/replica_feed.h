// Composes what a node publishes for observers (core/replica.h): at each tick the changes since the last tick, and key
// frames with all bodies. Uses neither clock nor network.
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

/// Number of steps between two ticks; at least 1. Every node publishes the states whose number is a multiple of it, so
/// an observer can put states of all regions together.
core::Step tick_steps(double step_hz, double tick_hz);

class ReplicaFeed {
 public:
  ReplicaFeed(core::RegionId self, core::Generation generation, std::uint64_t map_version);

  /// To be called after every step while somebody receives replicas. Notes the bodies that have left since the last
  /// tick.
  void note(const StepReport& report);

  /// To be called with each state while somebody receives replicas, before the changes are composed. Notes which bodies
  /// may have changed since the last tick, so that the others need not be looked at.
  void note(const core::Snapshot& snapshot);

  /// Composes the changes since the last tick. `snapshot`: the state of this tick, after the departures of its step.
  /// The result is valid until the next call.
  const core::Replica& compose_changes(const core::Snapshot& snapshot);

  /// Composes a key frame: all bodies of the same state, and those on their way from here. To be called after
  /// compose_changes(). The result is valid until the next call.
  const core::Replica& compose_key_frame(const core::Snapshot& snapshot, const std::deque<core::HandOff>& under_way);

  /// True if changes were published since the last key frame.
  bool changed_since_key_frame() const { return changed_since_key_frame_; }

  /// To be called when nobody receives replicas any more. The next receiver gets all bodies anew.
  void forget();

 private:
  struct Published {
    core::Epoch epoch = 0;
    bool asleep = false;
    core::Vec3 p_WB;
    Eigen::Quaternionf q_WB;
  };
  bool is_news(const core::BodyState& body) const;
  void compose_change(const core::BodyState& body);
  void compose_departures();
  void compose_removals(const core::Snapshot& snapshot);
  void begin(core::Replica& replica, core::Step stamp, bool key_frame) const;

  core::RegionId self_;
  core::Generation generation_;
  std::uint64_t map_version_;
  std::uint64_t sequence_ = 0;
  std::unordered_map<core::BodyId, Published> published_;
  struct Left {
    core::ReplicaBody row;  ///< the body under its new epoch
    core::Step birth = 0;   ///< state from which on the body is published
  };
  std::map<core::BodyId, Left> left_;  ///< bodies that have left since the last tick
  std::uint64_t seen_ = 0;             ///< number of the last snapshot
  bool all_may_have_changed_ = true;   ///< since the last tick
  std::vector<core::BodyId> changed_;  ///< else these
  core::Replica changes_;
  core::Replica all_;
  bool changed_since_key_frame_ = false;
};

}  // namespace aurasim::node
