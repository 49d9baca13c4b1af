#include "steering/run_steering.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/horizon.h"
#include "core/wall_clock.h"
#include "node/pacer.h"

namespace aurasim::steering {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Kind = messages::RunCommandKind;

/// Time in which a command reaches every node, seconds.
constexpr double kNoticeS = 0.3;

/// Time in which a step shows in the nodes' statuses.
constexpr auto kUntilShown = 1s;

}  // namespace

messages::RunCommand about_process(Kind kind, std::uint64_t run, core::RegionId region, std::uint64_t process) {
  messages::RunCommand command;
  command.kind = kind;
  command.run = run;
  command.region = region;
  command.process = process;
  return command;
}

bool RunSteering::belongs(const messages::SeenStatus& seen) const {
  return !seen.lost && !seen.has_ended() && seen.status.agreement == agreement_;
}

bool RunSteering::find_run(std::chrono::milliseconds time_out) {
  const auto deadline = Clock::now() + time_out;
  for (;;) {
    if (is_complete()) return true;
    if (Clock::now() > deadline) return is_there();
    control_.wait(50ms);
  }
}

bool RunSteering::is_complete() {
  std::size_t seen = 0;
  for (const auto& [region, status] : control_.statuses()) seen += status.status.agreement == agreement_;
  return is_there() && seen >= launch_.regions.size() && control_.listeners() > 0;
}

bool RunSteering::is_there() {
  const auto& statuses = control_.statuses();
  return std::any_of(statuses.begin(), statuses.end(), [this](const auto& s) { return belongs(s.second); });
}

bool RunSteering::is_paused() {
  const auto& statuses = control_.statuses();
  return std::all_of(statuses.begin(), statuses.end(), [this](const auto& s) {
    return !belongs(s.second) || s.second.status.state == messages::NodeState::kPaused;
  });
}

bool RunSteering::is_paused_within(core::Step states) {
  const auto& statuses = control_.statuses();
  return std::all_of(statuses.begin(), statuses.end(), [&](const auto& s) {
    const messages::Status& status = s.second.status;
    return !belongs(s.second) || (status.holds_at && *status.holds_at <= status.step + states);
  });
}

bool RunSteering::wait_until_paused(std::chrono::milliseconds time_out) {
  const auto deadline = Clock::now() + time_out;
  while (!is_paused() && Clock::now() < deadline) control_.wait(50ms);
  return is_paused();
}

/// Regions that are dead according to the statuses of live nodes, or whose own status has ended.
std::set<std::uint32_t> RunSteering::dead_regions() {
  std::set<std::uint32_t> dead;
  for (const auto& [region, seen] : control_.statuses()) {
    if (seen.status.agreement != agreement_) continue;
    const bool ended = seen.status.state == messages::NodeState::kFinished;
    if (!ended && !seen.is_live()) dead.insert(core::value_of(region));
    if (!seen.is_live()) continue;
    for (const core::RegionId other : seen.status.dead) dead.insert(core::value_of(other));
  }
  return dead;
}

messages::RunCommand RunSteering::send(Kind kind, std::int64_t count) {
  if (const auto dead = dead_regions(); kind == Kind::kReset && !dead.empty()) {
    throw SteeringRefused(
        fmt::format("reset: regions [{}] have no node now; send reset again once processes have taken them over",
                    fmt::join(dead, ", ")));
  }
  messages::RunCommand command;
  command.kind = kind;
  command.count = count;
  bool running = false;
  double rate = 0;
  for (const auto& [region, seen] : control_.statuses()) {
    if (!belongs(seen)) continue;
    command.run = seen.status.run;
    command.generation = std::max(command.generation, seen.status.generation);
    command.at_step = std::max(command.at_step, seen.status.step);
    rate = std::max(rate, seen.status.rate);
    running = running || seen.status.state == messages::NodeState::kRunning;
  }
  // Number of states computed in kNoticeS at this rate. The nodes hurry to the state if the rate is slow.
  const auto notice = static_cast<core::Step>(std::ceil(kNoticeS * launch_.time.step_hz * rate)) +
                      core::horizon::command_notice(launch_.lookahead());
  if (running) command.at_step += notice;
  if (kind == Kind::kStep) {
    command.at_step = std::max(command.at_step, stepped_to(command.generation)) + count;
    last_step_ = {command.generation, command.at_step, Clock::now()};
  }
  const double delay_s = kNoticeS + (running ? static_cast<double>(notice) * launch_.step_s() : 0);
  command.epoch_ns = core::wall_clock_ns() + static_cast<std::int64_t>(1e9 * delay_s);
  command.request = control_.send(command);
  return command;
}

/// The state that the last step command leads to. The statuses may not show it yet, and a second step has to add to it.
core::Step RunSteering::stepped_to(core::Generation generation) const {
  const bool is_news = last_step_.generation == generation && Clock::now() < last_step_.sent + kUntilShown;
  return is_news ? last_step_.until : 0;
}

messages::RunCommand RunSteering::send_step(core::Generation generation, core::Step from, std::int64_t count,
                                            const core::ProgramWord& after) {
  messages::RunCommand command;
  command.kind = Kind::kStep;
  command.count = count;
  command.generation = generation;
  command.at_step = from + count;
  command.after = after;
  for (const auto& [region, seen] : control_.statuses()) {
    if (belongs(seen)) command.run = seen.status.run;
  }
  command.epoch_ns = core::wall_clock_ns();
  command.request = control_.send(command);
  return command;
}

bool RunSteering::shows(const messages::Status& status, const messages::RunCommand& command) const {
  switch (command.kind) {
    case Kind::kPause:
    case Kind::kStep:
      return status.state == messages::NodeState::kPaused && status.step >= command.at_step;
    case Kind::kResume:
      return status.state == messages::NodeState::kRunning && status.step > command.at_step;
    case Kind::kReset:
      return status.generation > command.generation;
    case Kind::kStart:
      return status.state == messages::NodeState::kRunning;
    case Kind::kStop:
      return status.state == messages::NodeState::kFinished;
    case Kind::kRate:
      return status.rate == command.rate;
    case Kind::kLost:
    case Kind::kRestore:
    case Kind::kDrain:
    case Kind::kTake:
    case Kind::kEnd:
      break;  // commands between nodes and launchers
  }
  return false;
}

bool RunSteering::has_taken_effect(const messages::RunCommand& command) {
  const auto& statuses = control_.statuses();
  return std::all_of(statuses.begin(), statuses.end(), [&](const auto& entry) {
    const messages::SeenStatus& seen = entry.second;
    return seen.lost || seen.status.agreement != agreement_ || shows(seen.status, command);
  });
}

bool RunSteering::wait_for_effect(const messages::RunCommand& command, std::chrono::milliseconds time_out) {
  const auto deadline = Clock::now() + time_out;
  while (Clock::now() < deadline) {
    if (has_taken_effect(command)) return true;
    control_.wait(20ms);
  }
  return false;
}

}  // namespace aurasim::steering
