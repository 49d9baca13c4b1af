// The plan of a run on one node: when the next state is due, and in which states the run pauses, stops or begins again.
// Executes the run commands pause, step, resume, reset, stop and rate. Uses no DDS: time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "messages/control_messages.h"
#include "node/pacer.h"
#include "process/hold.h"

namespace aurasim::process {

class RunSchedule {
 public:
  using Clock = std::chrono::steady_clock;

  /// `step_s`: duration of a step in seconds. Without `keeps_pace` every state is due at once. `stop_at`: last state to
  /// compute.
  RunSchedule(double step_s, bool keeps_pace, std::optional<core::Step> stop_at)
      : step_s_(step_s), pacer_(step_s, keeps_pace), stop_at_(stop_at) {}

  /// Begins a world with state `first`, which is due at the time of `start`. The world is not paused.
  void begin_world(core::Step first, const messages::RunCommand& start, const node::Instant& now);
  /// State `first` of the world is there.
  void note_begun(core::Step first, Clock::time_point now);
  /// The run goes back to the state that `restore` names. `keeps_pause`: this node has sent the restore, and repeats
  /// the pause to the others (commands_to_repeat). `first`: state that the run began with.
  void go_back(const messages::RunCommand& restore, bool keeps_pause, core::Step first, const node::Instant& now);

  /// Executes a command of a kind named above. Commands of other kinds do nothing.
  void apply(const messages::RunCommand& command, const node::Instant& now);
  /// Pauses the run in `state`.
  void hold_in(core::Step state);
  /// A paused run goes back to `state` and is paused there.
  void hold_earlier_in(core::Step state);
  /// Follows other nodes that are paused in a later state (PauseFollower). `farthest`: the latest such state.
  void follow(core::Step farthest, Clock::time_point now);
  /// State in which the run is paused or will pause; nothing: it goes on.
  std::optional<core::Step> holds_at() const { return hold_at_; }
  bool is_held_in(core::Step state) const { return hold_at_ && state >= *hold_at_; }
  /// Time that the node has spent paused.
  void note_pause(Clock::duration time) { paused_ += time; }

  /// Time until `step` is due. In slow motion, states before a pause, a reset or the end are due as in real time.
  std::chrono::nanoseconds time_until(core::Step step, const node::Instant& now) const;
  /// A state has been computed.
  void note_computed(Clock::time_point now) { computed_at_ = now; }
  double rate() const { return pacer_.rate(); }
  /// Simulated seconds per second since the world began, pauses left out. `steps`: states computed since then.
  double real_time_factor(core::Step steps, Clock::time_point now) const;
  /// Wall-clock time at which `step` is due, nanoseconds since 1970.
  std::int64_t epoch_of(core::Step step, const node::Instant& now) const;

  /// Last state of the run, if it is known.
  std::optional<core::Step> stop_at() const { return stop_at_; }
  bool has_reset() const { return reset_.has_value(); }
  /// Generation in which the reset that was asked for was sent.
  std::optional<core::Generation> reset_of() const;
  bool reset_is_due(core::Step current) const { return reset_ && current >= reset_->at_step; }
  /// Returns the reset and forgets it. Precondition: has_reset().
  messages::RunCommand take_reset();

  /// Pause, reset and stop commands that the sender of `restore` sends again. A process that takes a region over has
  /// not received the pause, and the other nodes would drop the reset.
  std::vector<messages::RunCommand> commands_to_repeat(const messages::RunCommand& restore) const;
  /// The command that gives all nodes another rate soon after state `current`. The next step stays due when it was.
  messages::RunCommand rate_command(double rate, core::Step current, std::int64_t wall_ns) const;
  /// The command that makes a paused run compute up to a change in state `change`. A change needs its state to be
  /// confirmed. Nothing if the run is not paused in `current`.
  std::optional<messages::RunCommand> steps_to(core::Step change, core::Step current, core::Step confirmed,
                                               std::int64_t wall_ns) const;

 private:
  void step_on(const messages::RunCommand& step, const node::Instant& now);
  void hurry_to(core::Step state);

  double step_s_;
  node::Pacer pacer_;
  std::optional<core::Step> hold_at_;
  AskedSteps asked_steps_;  ///< steps asked for since the run was paused
  PauseFollower pause_follower_;
  std::optional<core::Step> stop_at_;
  std::optional<messages::RunCommand> reset_;
  core::Step hurry_until_ = 0;  ///< a client waits for this state: until then the pace is at least real time
  Clock::time_point computed_at_;
  std::optional<Clock::time_point> began_;
  Clock::duration paused_{};
};

}  // namespace aurasim::process
