// States of a whole world, as far as an observer has asked for them, from what all its regions say of them. No clock,
// no wire.
//
// A body on its way between hosts is in no region's hands for up to K - 1 states. Its former host names it; its next
// one makes the states up and tells them: when it joins, or before that in a run that stands. A state waits for that,
// and what does not come is named.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "cli/agent/told_bodies.h"
#include "core/observation.h"

namespace aurasim::cli::agent {

struct MergedState {
  core::Generation generation = 0;
  std::uint32_t redo = 0;
  core::Step step = 0;
  std::uint64_t sequence = 0;                  ///< the oldest interest that a region has answered
  std::uint64_t scene_order = 0;               ///< the newest that has changed the scene
  std::vector<WorldBody> bodies;               ///< ascending id; those in `missing` as they were when they left
  std::vector<core::BodyId> missing;           ///< under way, and nobody has said where; ascending
  std::vector<core::RegionId> silent;          ///< regions that have not said what they have of this state
  std::vector<core::JointState> joints;        ///< ascending id
  std::vector<core::ContactImpulse> contacts;  ///< ascending (a, b)

  bool is_complete() const { return missing.empty() && silent.empty(); }
};

struct MergeSettings {
  /// When all regions have told a state so much later than one, nothing more of that one comes.
  core::Step latest_steps = 8;
  double patience_s = 1;  ///< nor when it has begun to come so long ago
};

class MergedStates {
 public:
  explicit MergedStates(const MergeSettings& settings) : settings_(settings) {}

  /// `now_s`: of any clock that does not go back.
  void accept(core::Observation observation, double now_s);

  /// Those that are complete, or that nothing more comes of, without those that a region has left out because they were
  /// too many: in order, each once; after a redo again, from where it has
  /// gone back to. `regions`: those that are alive.
  std::vector<MergedState> take(const std::set<core::RegionId>& regions, double now_s);

  /// The highest generation that was heard of.
  std::optional<core::Generation> generation() const { return generation_; }

 private:
  struct Pending {
    std::uint32_t redo = 0;
    double since_s = 0;
    std::map<core::RegionId, core::Observation> hosted;
    std::vector<core::Observation> made_up;
  };

  void begin_generation(core::Generation generation);
  void go_back(core::Step to, std::uint32_t redo);
  bool is_over(core::Step step, const Pending& pending, const std::set<core::RegionId>& regions, double now_s) const;
  bool is_left_out(core::Step step, const Pending& pending) const;
  bool have_passed(core::Step step, const std::set<core::RegionId>& regions) const;
  MergedState merge(core::Step step, const Pending& pending, const std::set<core::RegionId>& regions) const;

  MergeSettings settings_;
  std::optional<core::Generation> generation_;
  std::uint32_t redo_ = 0;
  core::Step given_ = -1;  ///< up to this state
  bool has_given_ = false;
  std::map<core::Step, Pending> pending_;
  std::map<core::RegionId, core::Step> told_;  ///< the newest state of each region
  struct LeftOut {
    core::RegionId source{};
    core::Step first = 0, last = 0;
  };
  std::deque<LeftOut> left_out_;  ///< states that regions have not told, because the observer takes no more
};

}  // namespace aurasim::cli::agent
