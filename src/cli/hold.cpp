#include "cli/hold.h"

#include <algorithm>

namespace aurasim::cli {
namespace {

/// A command is under way for less than a second. What was asked for so long before is known to all.
constexpr std::size_t kMost = 1024;

}  // namespace

void AskedSteps::begin(core::Step state) {
  asked_.clear();
  begin_ = state;
}

void AskedSteps::add(const dds::RunCommand& step) {
  if (step.generation != generation_) begin(0);
  generation_ = step.generation;
  const Asked asked{step.at_step - step.count, step.request, step.count};
  const auto place = std::ranges::lower_bound(asked_, asked);
  if (place != asked_.end() && *place == asked) return;  // a copy
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

}  // namespace aurasim::cli
