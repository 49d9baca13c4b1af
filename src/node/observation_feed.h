// Composes what a node publishes for its observers (core/observation.h): in each state, for each observer, the bodies
// it wants among those hosted here or on their way from here. Uses neither clock nor network.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "core/interest.h"
#include "core/joint_motion.h"
#include "core/messages.h"
#include "core/observation.h"
#include "core/scene.h"
#include "node/node.h"

namespace aurasim::node {

struct FeedSettings {
  core::RegionId self{};
  core::Generation generation = 0;
  std::uint64_t map_version = 0;
  int lookahead = 1;
};

class ObservationFeed {
 public:
  /// `scene` must outlive the feed. Only the joints that it has now are observed.
  ObservationFeed(const FeedSettings& settings, const core::Scene& scene);

  /// To be called after every step while somebody observes. `under_way`: hand-offs that have not been acknowledged yet.
  void note(const StepReport& report, const std::deque<core::HandOff>& under_way);
  /// To be called when the first observer comes, or when the run has gone back. Replaces what was known of bodies under
  /// way, which is out of date then.
  void begin(core::Step step, const std::deque<core::HandOff>& under_way);

  /// Composes the observation of the state of `snapshot`, after the departures of its step. Precondition: note() has
  /// been called for that step. `contacts`: the contact impulses of the step.
  core::Observation compose(const core::Interest& interest, const core::Snapshot& snapshot,
                            const std::vector<core::ContactImpulse>& contacts, std::uint32_t redo) const;
  /// Composes the observation of a state that was made up here for bodies that have joined late.
  core::Observation compose(const core::Interest& interest, const MadeUp& state, std::uint32_t redo) const;

 private:
  struct Left {
    core::BodyState body;  ///< its state when it left, with its new epoch
    core::RegionId destination{};
    core::Step stamp = 0;
  };
  struct Joint {
    core::JointId id{};
    core::BodyId a{};
    std::optional<core::BodyId> b;
    core::JointFrame frame;
    int coordinate = 0;
  };

  core::Observation begin(const core::Interest& interest, core::Step stamp, std::uint32_t redo) const;
  void add_left(const core::Interest& interest, const core::Snapshot& snapshot, core::Observation& to) const;
  void add_outside(const core::Interest& interest, const core::Snapshot& snapshot, core::Observation& to) const;
  void add_joints(const core::Interest& interest, const std::vector<core::BodyState>& bodies,
                  core::Observation& to) const;
  void remember(const core::HandOff& hand_off, core::Step stamp);

  FeedSettings settings_;
  std::vector<Joint> joints_;  ///< joints with one coordinate, ascending id
  std::map<core::BodyId, Left> left_;
  std::map<core::BodyId, core::Step> arrived_;  ///< state in which a body came here or was removed here
};

}  // namespace aurasim::node
