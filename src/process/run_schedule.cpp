#include "process/run_schedule.h"

#include <algorithm>
#include <utility>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr double kRateNoticeS = 0.1;  ///< time in which all nodes receive a command

std::int64_t soon_ns(std::int64_t wall_ns) { return wall_ns + static_cast<std::int64_t>(1e9 * kRateNoticeS); }

}  // namespace

void RunSchedule::begin_world(core::Step first, const messages::RunCommand& start, const node::Instant& now) {
  pacer_.set_epoch(first, start.epoch_ns, start.clock_ahead, now);
  hold_at_.reset();
  paused_ = {};
  hurry_until_ = 0;
}

void RunSchedule::note_begun(core::Step first, Clock::time_point now) { began_ = std::max(pacer_.due(first), now); }

void RunSchedule::go_back(const messages::RunCommand& restore, bool keeps_pause, core::Step first,
                          const node::Instant& now) {
  pacer_.set_rate(restore.rate, restore.at_step, restore.epoch_ns, restore.clock_ahead, now);
  reset_.reset();
  if (!keeps_pause) hold_at_.reset();
  if (!began_) began_ = pacer_.due(first);
  hurry_until_ = 0;
}

void RunSchedule::apply(const messages::RunCommand& command, const node::Instant& now) {
  using Kind = messages::RunCommandKind;
  switch (command.kind) {
    case Kind::kStart:
    case Kind::kLost:
    case Kind::kRestore:
    case Kind::kDrain:
    case Kind::kTake:
    case Kind::kEnd:
      break;
    case Kind::kPause:
      hold_in(command.at_step);
      hurry_to(command.at_step);
      break;
    case Kind::kStep:
      if (hold_at_) step_on(command, now);
      break;
    case Kind::kResume:
      if (hold_at_) pacer_.set_epoch(*hold_at_ + 1, command.epoch_ns, command.clock_ahead, now);
      hold_at_.reset();
      break;
    case Kind::kReset:
      reset_ = command;
      hurry_to(command.at_step);
      break;
    case Kind::kStop:
      stop_at_ = std::min(stop_at_.value_or(command.at_step), command.at_step);
      hurry_to(command.at_step);
      break;
    case Kind::kRate:
      pacer_.set_rate(command.rate, command.at_step, command.epoch_ns, command.clock_ahead, now);
      break;
  }
}

void RunSchedule::hold_in(core::Step state) {
  hold_at_ = state;
  asked_steps_.begin(state);
}

void RunSchedule::hold_earlier_in(core::Step state) {
  if (hold_at_) hold_at_ = state;
}

/// Executes a step command in a paused run. States of earlier step commands keep their pace.
void RunSchedule::step_on(const messages::RunCommand& step, const node::Instant& now) {
  const core::Step next = *hold_at_ + 1;
  node::Pacer later = pacer_;
  later.set_epoch(next, step.epoch_ns, step.clock_ahead, now);
  if (later.due(next) > pacer_.due(next)) pacer_ = later;
  asked_steps_.add(step);
  hold_at_ = std::max(*hold_at_, asked_steps_.end());
}

void RunSchedule::hurry_to(core::Step state) { hurry_until_ = std::max(hurry_until_, state); }

void RunSchedule::follow(core::Step farthest, Clock::time_point now) {
  if (hold_at_) hold_at_ = pause_follower_.holds_at(*hold_at_, farthest, now);
}

std::chrono::nanoseconds RunSchedule::time_until(core::Step step, const node::Instant& now) const {
  const std::chrono::nanoseconds until = pacer_.until(step, now);
  if (step > hurry_until_) return until;
  const auto in_real_time = computed_at_ + std::chrono::duration<double>(step_s_) - now.steady;
  return std::min(until, std::max(0ns, std::chrono::duration_cast<std::chrono::nanoseconds>(in_real_time)));
}

double RunSchedule::real_time_factor(core::Step steps, Clock::time_point now) const {
  const double wall_s = began_ ? std::chrono::duration<double>(now - *began_ - paused_).count() : 0;
  return wall_s > 0 ? static_cast<double>(steps) * step_s_ / wall_s : 1;
}

std::int64_t RunSchedule::epoch_of(core::Step step, const node::Instant& now) const {
  return now.wall_ns + std::chrono::nanoseconds(pacer_.due(step) - now.steady).count();
}

std::optional<core::Generation> RunSchedule::reset_of() const {
  return reset_ ? std::optional(reset_->generation) : std::nullopt;
}

messages::RunCommand RunSchedule::take_reset() { return *std::exchange(reset_, std::nullopt); }

std::vector<messages::RunCommand> RunSchedule::commands_to_repeat(const messages::RunCommand& restore) const {
  std::vector<messages::RunCommand> commands;
  const auto repeat = [&](messages::RunCommandKind kind, core::Step at_step) {
    messages::RunCommand command;
    command.generation = restore.generation;
    command.run = restore.run;
    command.kind = kind;
    command.at_step = at_step;
    commands.push_back(command);
  };
  if (reset_) repeat(messages::RunCommandKind::kReset, std::max(reset_->at_step, restore.at_step));
  if (hold_at_) repeat(messages::RunCommandKind::kPause, *hold_at_);
  if (stop_at_) repeat(messages::RunCommandKind::kStop, *stop_at_);
  return commands;
}

messages::RunCommand RunSchedule::rate_command(double rate, core::Step current, std::int64_t wall_ns) const {
  const double steps = std::min(pacer_.rate(), 1.0) * kRateNoticeS / step_s_;
  messages::RunCommand command;
  command.kind = messages::RunCommandKind::kRate;
  command.at_step = current + 1 + static_cast<core::Step>(steps);
  command.epoch_ns = soon_ns(wall_ns);
  command.rate = rate;
  return command;
}

std::optional<messages::RunCommand> RunSchedule::steps_to(core::Step change, core::Step current, core::Step confirmed,
                                                          std::int64_t wall_ns) const {
  if (!is_held_in(current)) return std::nullopt;
  const core::Step until_certain = current - confirmed;
  messages::RunCommand command;
  command.kind = messages::RunCommandKind::kStep;
  command.count = std::max<core::Step>(1, change + until_certain - *hold_at_);
  command.at_step = *hold_at_ + command.count;
  command.epoch_ns = soon_ns(wall_ns);
  return command;
}

}  // namespace aurasim::process
