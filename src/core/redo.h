// What leads to a redo (docs/design.md, "Checked, and computed again"): two bodies of two hosts were found to have
// touched, or a static to have been elsewhere than it was to be, so what has been computed since may be wrong. All
// nodes go back to a cut from before, bring the two to one host in time, and go on from there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"

namespace aurasim::core {

/// Two bodies, a < b, may have had a contact while state `step` was computed, each on a host of its own.
struct Alarm {
  std::uint32_t redo = 0;  ///< how often the run had been put back when it was raised
  Step step = 0;
  BodyId a{};
  BodyId b{};
};

/// In an alarm that is about no pair: a static was elsewhere than it was ordered to be. Ids that no body has.
inline constexpr BodyId kNobody{(std::uint64_t{1} << 63) - 2}, kNobodyElse{(std::uint64_t{1} << 63) - 1};

inline bool is_about_a_pair(const Alarm& alarm) { return alarm.a != kNobody; }

/// Two bodies, a < b, that share a host from as soon as possible until `until`, whatever their auras say.
struct TogetherPair {
  BodyId a{};
  BodyId b{};
  Step until = 0;
};

/// The alarms of a run: every node publishes each once, in its next batch, so after as many hops as two regions can be
/// apart everybody knows them. Survives a redo.
class AlarmLog {
 public:
  /// Our own. Once for each pair between two redos.
  void raise(Step step, BodyId a, BodyId b);
  void receive(std::span<const Alarm> alarms);
  std::vector<Alarm> take_to_publish();

  /// The run has been put back to state `base`: later states are computed anew, earlier alarms still hold.
  void put_back(Step base);
  std::uint32_t redo() const { return static_cast<std::uint32_t>(bases_.size()); }

  /// Alarms about states that have not been computed again since.
  std::span<const Alarm> standing() const { return standing_; }

 private:
  bool stands(const Alarm& alarm) const;
  void add(const Alarm& alarm);

  std::vector<Step> bases_;  ///< of each redo so far
  std::vector<Alarm> standing_;
  std::vector<Alarm> to_publish_;
};

}  // namespace aurasim::core
