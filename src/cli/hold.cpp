#include "cli/hold.h"

#include <algorithm>

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongestUnderWay = 200ms;  ///< of a command to a node, also if it is lost once or twice
constexpr auto kPatienceWithWords = 1s;

}  // namespace

std::optional<core::Step> holds_at_after(const dds::RunCommand& command, std::optional<core::Step> holds_at) {
  using Kind = dds::RunCommandKind;
  if (command.kind == Kind::kPause) return command.at_step;
  if (command.kind == Kind::kResume) return std::nullopt;
  if (command.kind == Kind::kStep && holds_at) return std::max(*holds_at, command.at_step);
  return holds_at;
}

core::Step first_state_of(const dds::RunCommand& step) { return step.at_step - step.count + 1; }

core::Step PauseFollower::holds_at(core::Step holds_at, core::Step farthest, Time now) {
  if (farthest <= holds_at) {
    behind_since_.reset();
    return holds_at;
  }
  if (!behind_since_) behind_since_ = now;
  return now < *behind_since_ + kLongestUnderWay ? holds_at : farthest;
}

void AwaitedWords::add(const dds::RunCommand& step, Time now) {
  if (step.after.number > 0) words_.push_back({step.after, now});
}

bool AwaitedWords::are_here(const HasHeard& has_heard, Time now) {
  std::erase_if(words_, [&](const Awaited& awaited) {
    if (has_heard(awaited.word)) return true;
    if (now < awaited.since + kPatienceWithWords) return false;
    given_up_.push_back(awaited.word);
    return true;
  });
  return words_.empty();
}

}  // namespace aurasim::cli
