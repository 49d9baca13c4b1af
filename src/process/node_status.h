// The status that a node publishes about itself some times a second: what it contains, and when it is due. Uses no DDS:
// time is passed in.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "config/launch.h"
#include "messages/control_messages.h"
#include "messages/status_period.h"
#include "node/node.h"
#include "node/step_report.h"

namespace aurasim::process {

/// Durations of the steps of about the last second, milliseconds.
class FrameWindow {
 public:
  using Clock = std::chrono::steady_clock;

  explicit FrameWindow(Clock::time_point now) : begin_(now) {}

  void note(double frame_ms, const node::Durations& durations, Clock::time_point now);
  void note_exchanges(std::span<const double> seconds);
  /// Writes the percentiles of the window into `status`.
  void summarize(messages::Status& status);

 private:
  Clock::time_point begin_;
  std::vector<double> frame_, physics_, protocol_, transport_, exchange_;
};

/// The part of a status that others wait for, beside the node's state.
struct Awaited {
  core::Generation generation = 0;
  std::optional<core::Step> holds_at;
  core::Step stands_in = 0;  ///< state of a pause; 0: no pause
  bool operator==(const Awaited&) const = default;
};

class NodeStatus {
 public:
  using Clock = std::chrono::steady_clock;

  /// `identity`: fields of the status that stay the same as long as the process lives. `regions`: number of the run's.
  NodeStatus(const messages::Status& identity, Clock::time_point now, std::size_t regions = 1)
      : status_(identity), period_(messages::status_period(regions)), window_(now) {}

  const messages::Status& content() const { return status_; }
  messages::Status& content() { return status_; }

  /// The run goes on with the regions of this launch.
  void use_regions(const config::Launch& launch);
  /// The run's exchange has been chosen.
  void use_exchange(const config::Launch& launch);
  /// Counts a state that was computed in `frame_ms`.
  void note_step(const node::StepReport& report, double frame_ms, Clock::time_point now);
  /// Counts the exchanges of that state where regions are coupled.
  void note_exchanges(std::span<const double> seconds) { window_.note_exchanges(seconds); }
  /// Counts bodies that have changed their hosts without a step.
  void note_moved(const node::StepReport& moved);
  /// Takes over what `node` counts by itself, and the percentiles of the last second.
  void note_node(const node::Node& node);
  /// Replaces the regions that the node does not receive from. A change is published at once, because the others wait
  /// for a node that does not receive from all.
  void note_unreachable(std::vector<core::RegionId> unreachable);
  /// Counts messages of processes that are no neighbours and that were refused; 0: none.
  void note_refused_strangers(std::uint64_t count);
  /// Number of messages of this region that were refused.
  std::uint64_t refused_of(core::RegionId region) const;

  /// True if some time has passed since the last status.
  bool period_is_over(Clock::time_point now) const;
  /// True if what others wait for differs from the last status, and that was some time ago. A period may be longer.
  bool is_awaited(const Awaited& awaited, Clock::time_point now) const;
  /// True if a status is due: its period is over, or the node's state has changed.
  bool is_due(messages::NodeState state, Clock::time_point now) const;
  /// The next status is due at once, because others wait for it.
  void make_due() { published_ = {}; }
  /// A status with this state is published now.
  void note_published(messages::NodeState state, const Awaited& awaited, Clock::time_point now);

 private:
  messages::Status status_;
  std::chrono::milliseconds period_;
  FrameWindow window_;
  Clock::time_point published_;
  Awaited awaited_;  ///< of the last status
};

}  // namespace aurasim::process
