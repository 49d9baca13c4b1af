#include "process/run_control_limits.h"

#include <cmath>

#include <fmt/format.h>

#include "core/limits.h"
#include "node/pacer.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Kind = messages::RunCommandKind;

constexpr auto kLongestWay = 5s;  ///< of a command to a node
constexpr auto kLookEvery = 500ms;
constexpr double kFarthestEpochS = 60;
constexpr core::Generation kMostGenerationsAhead = 1000;

bool names_a_state(Kind kind) {
  return kind == Kind::kPause || kind == Kind::kStep || kind == Kind::kReset || kind == Kind::kStop ||
         kind == Kind::kRate;
}

bool names_a_time(Kind kind) {
  return kind == Kind::kStart || kind == Kind::kStep || kind == Kind::kResume || kind == Kind::kReset ||
         kind == Kind::kRate || kind == Kind::kRestore;
}

/// From now to the epoch, by the sender's clock where that is not ours.
double ahead_s(const messages::RunCommand& command, std::int64_t now_ns) {
  const bool differs = std::chrono::abs(command.clock_ahead) > node::kClockTolerance;
  const double clock_s = differs ? std::chrono::duration<double>(command.clock_ahead).count() : 0;
  return 1e-9 * (static_cast<double>(command.epoch_ns) - static_cast<double>(now_ns)) - clock_s;
}

}  // namespace

void RunControlLimits::note(core::Step step, Time now) {
  if (!past_.empty() && step < past_.back().step) {  // put back: states before `step` stay past
    const Time oldest = past_.front().when;
    while (!past_.empty() && past_.back().step >= step) past_.pop_back();
    if (past_.empty()) past_.push_back({oldest, step});
    past_.push_back({now, step});
    return;
  }
  if (!past_.empty() && now < past_.back().when + kLookEvery) return;
  past_.push_back({now, step});
  while (past_.size() > 1 && past_[1].when + kLongestWay <= now) past_.pop_front();
}

std::string RunControlLimits::problem_with(const messages::RunCommand& command, core::Generation generation,
                                           std::int64_t now_ns) const {
  if (command.kind == Kind::kRestore && command.generation > generation + kMostGenerationsAhead) {
    return fmt::format("generation {} after {}", command.generation, generation);
  }
  if (names_a_time(command.kind)) {
    const double ahead = ahead_s(command, now_ns);
    const bool is_past =
        ahead < -kFarthestEpochS && command.kind != Kind::kRestore;  // a run may be far behind its time
    if (is_past || ahead > kFarthestEpochS) {
      return fmt::format("a time {:.3g} s {}, allowed: {:g} s", std::abs(ahead), is_past ? "ago" : "ahead",
                         kFarthestEpochS);
    }
  }
  return names_a_state(command.kind) ? problem_with_state(command) : std::string();
}

std::string RunControlLimits::problem_with_state(const messages::RunCommand& command) const {
  if (past_.empty()) return {};
  const bool is_long_ago = past_.front().when + kLongestWay <= past_.back().when;
  if (is_long_ago && command.at_step < past_.front().step) {
    return fmt::format("state {} was past {} s ago", command.at_step, kLongestWay.count());
  }
  if (command.at_step > past_.back().step + core::limits::kMostStepsAhead ||
      command.count > core::limits::kMostStepsAhead) {
    return fmt::format("more than {} states ahead", core::limits::kMostStepsAhead);
  }
  return {};
}

}  // namespace aurasim::process
