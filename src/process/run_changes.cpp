#include "process/run_changes.h"

#include <algorithm>
#include <utility>

namespace aurasim::process {
namespace {

constexpr int kMostFailedChanges = 3;  ///< in a row

}  // namespace

bool all_wait_in(const std::map<core::RegionId, messages::SeenStatus>& nodes, core::RegionId self,
                 core::Generation generation, core::Step step) {
  return std::ranges::all_of(nodes, [&](const auto& entry) {
    const messages::Status& status = entry.second.status;
    const bool is_here =
        status.state == messages::NodeState::kPaused && status.generation == generation && status.step >= step;
    return entry.first == self || is_here || status.generation > generation;
  });
}

std::vector<core::Step> RunChanges::states_to_keep() const {
  std::vector<core::Step> states;
  for (const core::Order& order : waiting_) {
    if (core::changes_the_run(order.action)) states.push_back(order.at_step);
  }
  return states;
}

bool RunChanges::is_about_to_change(core::Step current) const {
  return std::ranges::any_of(waiting_, [current](const core::Order& order) {
    return core::changes_the_run(order.action) && current >= order.at_step;
  });
}

std::vector<core::Step> RunChanges::take_reached(core::Step current, core::Step confirmed) {
  std::vector<core::Step> states;
  std::erase_if(waiting_, [&](const core::Order& order) {
    const bool changes = core::changes_the_run(order.action);
    if (current < order.at_step || (changes && confirmed < order.at_step)) return false;
    if (changes) {
      states.push_back(order.at_step);
      due_ = order;
    }
    return true;
  });
  return states;
}

core::Order RunChanges::begin(Before before) {
  before_ = std::move(before);
  return *std::exchange(due_, std::nullopt);
}

void RunChanges::finish() {
  failed_ = 0;
  before_.reset();
}

bool RunChanges::may_try_again() { return ++failed_ <= kMostFailedChanges; }

std::optional<RunChanges::Before> RunChanges::drop() {
  waiting_.clear();
  due_.reset();
  return std::exchange(before_, std::nullopt);
}

}  // namespace aurasim::process
