// Merges the observations of all regions into states of the whole world, as far as an observer has asked for them. Uses
// no clock and no network.
//
// A body on its way between hosts belongs to no region for up to K - 1 states. Its former host names it. Its next host
// makes its states up and publishes them: when it joins, or earlier in a paused run. A state waits for them, and lists
// the bodies whose states do not come.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "agent/told_bodies.h"
#include "core/observation.h"

namespace aurasim::agent {

struct MergedState {
  core::Generation generation = 0;
  std::uint32_t redo = 0;
  core::Step step = 0;
  std::uint64_t sequence = 0;                  ///< the oldest interest that a region has answered
  std::uint64_t scene_order = 0;               ///< sequence of the newest order that has changed the scene
  std::vector<WorldBody> bodies;               ///< ascending id; bodies in `missing` are as they were when they left
  std::vector<core::BodyId> missing;           ///< bodies under way whose place is unknown; ascending
  std::vector<core::RegionId> silent;          ///< regions whose observation of this state has not come
  std::vector<core::JointState> joints;        ///< ascending id
  std::vector<core::ContactImpulse> contacts;  ///< ascending (a, b)

  bool is_complete() const { return missing.empty() && silent.empty(); }
};

struct MergeSettings {
  /// A state is over when all regions have published one so many steps later.
  core::Step latest_steps = 8;
  double patience_s = 1;  ///< a state is over so many seconds after its first observation, too
};

class MergedStates {
 public:
  explicit MergedStates(const MergeSettings& settings) : settings_(settings) {}

  /// Takes in an observation. `now_s`: seconds of any clock that does not go back.
  void accept(core::Observation observation, double now_s);

  /// The states that are complete or over, in order, each once. States that a region has left out for a slow observer
  /// are skipped. After a redo, states come again from the one that it went back to. `regions`: live regions.
  std::vector<MergedState> take(const std::set<core::RegionId>& regions, double now_s);

  /// The highest generation received.
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
  core::Step given_ = -1;  ///< the newest state given out
  bool has_given_ = false;
  std::map<core::Step, Pending> pending_;
  std::map<core::RegionId, core::Step> told_;  ///< the newest state of each region
  struct LeftOut {
    core::RegionId source{};
    core::Step first = 0, last = 0;
  };
  std::deque<LeftOut> left_out_;  ///< states that regions have left out, because the observer was too slow
};

}  // namespace aurasim::agent
