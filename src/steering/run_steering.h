// Commands to a whole run. Each names the state at which it takes effect, far enough ahead that every node receives it
// before it gets there.
#pragma once

#include <chrono>
#include <set>
#include <stdexcept>

#include "config/launch.h"
#include "dds/control.h"

namespace aurasim::steering {

/// Thrown with the reason when a run cannot execute a command.
class SteeringRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A command about one node, or to one spare: lost, drain, take.
messages::RunCommand about_process(messages::RunCommandKind kind, std::uint64_t run, core::RegionId region,
                                   std::uint64_t process);

class RunSteering {
 public:
  /// `launch` and `control` must outlive this object.
  RunSteering(const config::Launch& launch, dds::ControlBus& control)
      : launch_(launch), agreement_(launch.agreement()), control_(control) {}

  /// Waits until the statuses of all live regions of this launch have been seen; false at the time-out.
  bool find_run(std::chrono::milliseconds time_out);

  /// Judged by the statuses seen so far. is_complete(): all regions have published a status and receive commands.
  /// is_there(): any node of this launch is alive. is_paused(): all live nodes are paused.
  bool is_complete();
  bool is_there();
  bool is_paused();
  /// True if the run is paused, or will be before it has computed `states` more states.
  bool is_paused_within(core::Step states);
  /// Waits until the run is paused; false at the time-out.
  bool wait_until_paused(std::chrono::milliseconds time_out);

  /// Sends a command that takes effect as soon as all nodes can have received it; returns what was sent. Throws
  /// SteeringRefused when the run cannot do that any more.
  messages::RunCommand send(messages::RunCommandKind kind, std::int64_t count = 1);

  /// Orders a run that is paused in state `from` of this generation to compute the next `count` states at once. For a
  /// client that waits for each step. No node computes them before it has received the setpoints that `after` names.
  messages::RunCommand send_step(core::Generation generation, core::Step from, std::int64_t count,
                                 const core::ProgramWord& after);

  /// True if every live node's status shows the effect of `command`.
  bool has_taken_effect(const messages::RunCommand& command);

  /// Waits until every live node shows the effect of `command`; false at the time-out.
  bool wait_for_effect(const messages::RunCommand& command, std::chrono::milliseconds time_out);

 private:
  struct Step {
    core::Generation generation = 0;
    core::Step until = 0;
    std::chrono::steady_clock::time_point sent;
  };

  std::set<std::uint32_t> dead_regions();
  core::Step stepped_to(core::Generation generation) const;
  bool belongs(const messages::SeenStatus& seen) const;
  bool shows(const messages::Status& status, const messages::RunCommand& command) const;

  const config::Launch& launch_;
  std::uint64_t agreement_;
  dds::ControlBus& control_;
  Step last_step_;
};

}  // namespace aurasim::steering
