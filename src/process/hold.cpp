#include "process/hold.h"

#include <algorithm>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongestUnderWay = 200ms;  ///< longest time of a command to a node, including one or two losses
constexpr auto kPatienceWithWords = 1s;
/// Limit of step commands kept one by one. A command is under way for less than a second, so all nodes know the older
/// ones.
constexpr std::size_t kMost = 1024;

}  // namespace

void AskedSteps::begin(core::Step state) {
  asked_.clear();
  begin_ = state;
}

void AskedSteps::add(const messages::RunCommand& step) {
  if (step.generation != generation_) begin(0);
  generation_ = step.generation;
  const Asked asked{step.at_step - step.count, step.request, step.count};
  const auto place = std::ranges::lower_bound(asked_, asked);
  if (place != asked_.end() && *place == asked) return;  // a repetition
  asked_.insert(place, asked);
  if (asked_.size() <= kMost) return;
  begin_ = std::max(begin_, asked_.front().from) + asked_.front().count;
  asked_.erase(asked_.begin());
}

core::Step AskedSteps::end() const {
  core::Step end = begin_;
  for (const Asked& asked : asked_) end = std::max(end, asked.from) + asked.count;
  return end;
}

core::Step PauseFollower::holds_at(core::Step holds_at, core::Step farthest, Time now) {
  if (farthest <= holds_at) {
    behind_since_.reset();
    return holds_at;
  }
  if (!behind_since_) behind_since_ = now;
  return now < *behind_since_ + kLongestUnderWay ? holds_at : farthest;
}

core::Step farthest_pause(const std::map<core::RegionId, messages::SeenStatus>& nodes, core::Generation generation) {
  core::Step farthest = 0;
  for (const auto& [region, seen] : nodes) {
    const messages::Status& status = seen.status;
    const bool is_paused = status.state == messages::NodeState::kPaused && status.generation == generation;
    if (is_paused && seen.is_live()) farthest = std::max(farthest, status.step);
  }
  return farthest;
}

void AwaitedWords::add(const messages::RunCommand& step, Time now) {
  if (step.after.number > 0) words_.push_back({step.after, now});
}

bool AwaitedWords::name(const core::ProgramWord& word) const {
  return std::ranges::any_of(words_, [&word](const Awaited& awaited) {
    return awaited.word.program == word.program && awaited.word.number >= word.number;
  });
}

bool AwaitedWords::are_here(const HasReceived& has_received, Time now) {
  std::erase_if(words_, [&](const Awaited& awaited) {
    if (has_received(awaited.word)) return true;
    if (now < awaited.since + kPatienceWithWords) return false;
    given_up_.push_back(awaited.word);
    return true;
  });
  return words_.empty();
}

}  // namespace aurasim::process
