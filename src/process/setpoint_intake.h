// Gives the setpoints of programs (topic control, ROS 2) to the node, counts those that are late or refused, and makes
// the node wait for setpoints that a step command names. Uses no DDS: time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/control_log.h"
#include "core/setpoint.h"
#include "messages/control_messages.h"
#include "process/hold.h"

namespace aurasim::process {

/// Numbers of setpoint messages since the start of the process.
struct SetpointCounts {
  std::uint64_t received = 0;
  std::uint64_t late = 0;     ///< came after their state had been computed here
  std::uint64_t refused = 0;  ///< not taken by the node, given up, or more than a body can bear
};

class SetpointIntake {
 public:
  using Clock = std::chrono::steady_clock;
  /// Gives setpoints to the node, as node::Node::hear.
  using Give = std::function<core::Heard(const core::Setpoints&, bool known_to_all)>;

  /// To be called when another world begins. Setpoints for the world before are not waited for.
  void begin_world() {
    awaited_.clear();
    kept_.clear();
  }
  /// Gives `received` to the node, which is in state `step`. `endpoints_refused`: number of messages that the DDS
  /// endpoints have refused so far. `holds_at`: the state in which the run pauses; nothing: no pause. Setpoints of
  /// statics for states after a pause are kept until a command ends it. If that is a step that names them, all nodes
  /// receive them before they compute on, and the node is told so.
  void take(std::span<const core::Setpoints> received, std::uint64_t endpoints_refused, core::Step step,
            std::optional<core::Step> holds_at, const Give& give);
  /// Counts setpoints that were refused because a body would have become too fast.
  void note_unbearable(std::uint64_t count) { unbearable_ += count; }

  /// No state is computed until the setpoints that this step command names have been received.
  void await(const messages::RunCommand& step, Clock::time_point now) { awaited_.add(step, now); }
  /// True if all awaited setpoints have been received or given up. `next`: the state that is to be computed.
  bool has_all_awaited(const AwaitedWords::HasReceived& has_received, core::Step next, Clock::time_point now);

  const SetpointCounts& counts() const { return counts_; }

 private:
  void give_to_node(const core::Setpoints& setpoints, core::Step step, const Give& give);

  AwaitedWords awaited_;
  std::vector<core::Setpoints> kept_;  ///< with statics, for states after the pause
  SetpointCounts counts_;
  std::uint64_t not_taken_ = 0, unbearable_ = 0;
  bool late_logged_ = false, refused_logged_ = false;  ///< the message about them has been logged
};

}  // namespace aurasim::process
