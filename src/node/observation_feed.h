// What a node tells its observers (core/observation.h): in each state what each of them wants of what is hosted here,
// or on its way from here. Knows neither clock nor wire.
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
  /// The scene outlives it; its joints are those of the beginning.
  ObservationFeed(const FeedSettings& settings, const core::Scene& scene);

  /// After every step while somebody asks. `under_way`: hand-offs that nobody has acknowledged yet.
  void note(const StepReport& report, const std::deque<core::HandOff>& under_way);
  /// Nobody has asked until now, or the run has gone back: what was known of bodies under way is out of date.
  void begin(core::Step step, const std::deque<core::HandOff>& under_way);

  /// Of the state of `snapshot`, after the departures of its step, which note() has heard of. `contacts`: of the step.
  core::Observation compose(const core::Interest& interest, const core::Snapshot& snapshot,
                            const std::vector<core::ContactImpulse>& contacts, std::uint32_t redo) const;
  /// Of a state that was made up here for bodies that have joined late.
  core::Observation compose(const core::Interest& interest, const MadeUp& state, std::uint32_t redo) const;

 private:
  struct Left {
    core::BodyState body;  ///< as it left, under its new epoch
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
  std::vector<Joint> joints_;  ///< those with one coordinate, ascending id
  std::map<core::BodyId, Left> left_;
  std::map<core::BodyId, core::Step> arrived_;  ///< or were taken out: accounted for here
};

}  // namespace aurasim::node
