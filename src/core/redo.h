// Alarms, which lead to a redo (docs/design.md, "Checked, and computed again"). Two bodies of two hosts were found to
// have touched, or a static was in the wrong place, so later states may be wrong. All nodes go back to an earlier cut,
// bring the two bodies to one host in time, and compute on from there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"

namespace aurasim::core {

/// Two bodies, a < b, may have had a contact while state `step` was computed, each on a host of its own.
struct Alarm {
  std::uint32_t redo = 0;  ///< number of redos before the alarm was raised
  Step step = 0;
  BodyId a{};
  BodyId b{};
};

/// Ids of no body, for an alarm about a static that was not where it was ordered to be.
inline constexpr BodyId kNobody{(std::uint64_t{1} << 63) - 2}, kNobodyElse{(std::uint64_t{1} << 63) - 1};

inline bool is_about_a_pair(const Alarm& alarm) { return alarm.a != kNobody; }

/// Two bodies, a < b, that share a host from as soon as possible until `until`, whatever their auras say.
struct TogetherPair {
  BodyId a{};
  BodyId b{};
  Step until = 0;
};

/// The alarms of a run: every node publishes each alarm once, in its next batch after the alarm has arrived. So all
/// nodes have it after as many batches as two regions are hops apart. The log survives a redo.
class AlarmLog {
 public:
  /// Adds an alarm of our own; at most one for each pair between two redos.
  void raise(Step step, BodyId a, BodyId b);
  void receive(std::span<const Alarm> alarms);
  std::vector<Alarm> take_to_publish();

  /// Call after a redo that went back to state `base`. Alarms about later states are dropped, earlier ones still stand.
  void put_back(Step base);
  std::uint32_t redo() const { return static_cast<std::uint32_t>(bases_.size()); }

  /// Alarms about states that have not been computed again since.
  std::span<const Alarm> standing() const { return standing_; }

 private:
  bool stands(const Alarm& alarm) const;
  void add(const Alarm& alarm);

  std::vector<Step> bases_;  ///< state of the cut of each redo so far
  std::vector<Alarm> standing_;
  std::vector<Alarm> to_publish_;
};

}  // namespace aurasim::core
