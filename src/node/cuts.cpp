#include "node/cuts.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/horizon.h"

namespace aurasim::node {
namespace {

/// Number of older cuts that are kept for pairs that one redo does not bring together.
constexpr std::size_t kOlderCuts = 4;
/// So many redos in a row for the same pair go back farther each time.
constexpr std::size_t kMostStubborn = 1 + kOlderCuts;

constexpr std::size_t kMostCuts = 40;

/// Memory of so many dropped cuts is kept for new ones.
constexpr std::size_t kMostMemory = 4;

/// True if the cut is kept for pairs that a redo has not brought together.
bool is_older_kind(const Cut& cut) { return cut.step % core::horizon::kBetweenOlderCuts == 0; }

bool same_pair(const core::TogetherPair& pair, const core::Alarm& alarm) {
  return pair.a == alarm.a && pair.b == alarm.b;
}

}  // namespace

void Cut::note_arrival(const core::Adoption& adoption) {
  if (adoption.stamp <= step) joining.push_back(adoption);
}

void Cuts::keep(Cut cut) {
  core::free_spare_memory(cut.bodies);
  cuts_.push_back(std::move(cut));
}

void Cuts::note_arrival(const core::Adoption& adoption) {
  for (Cut& cut : cuts_) cut.note_arrival(adoption);
}

void Cuts::note_spawn(const core::Order& order) {
  for (Cut& cut : cuts_) cut.to_be_born.spawns.push_back(order);
}

void Cuts::forget(core::Step confirmed, bool alarms_given_up) {
  // The state after a redo's cut may be the next one to cause a redo.
  const core::Step needed = before(before(confirmed + 1, 1).step + 1, 1).step;
  const core::Step oldest_needed = before(confirmed + 1, kMostStubborn).step;
  std::erase_if(cuts_, [&](Cut& cut) {
    const bool stays =
        cut.step >= needed || cut.step == oldest_needed || (cut.step > oldest_needed && is_older_kind(cut));
    if (!stays) drop(cut);
    return !stays;
  });
  if (!alarms_given_up || cuts_.size() <= kMostCuts) return;
  drop(cuts_.front());
  cuts_.pop_front();
}

/// The newest cut early enough to gather a pair that touched in state `touch`. If `farther` is 1, the newest one early
/// enough to pull it to one host. If it is more, so many cuts of the older kind before that.
const Cut& Cuts::before(core::Step touch, std::size_t farther) const {
  const core::Step wanted =
      touch - (farther == 0 ? core::horizon::kBeforeTouch : core::horizon::before_pull(lookahead_));
  std::size_t at = 0;
  while (at + 1 < cuts_.size() && cuts_[at + 1].step <= wanted) ++at;
  for (; farther > 1 && at > 0; --farther) {
    do {
      --at;
    } while (at > 0 && !is_older_kind(cuts_[at]));
  }
  return cuts_[at];
}

void Cuts::drop(Cut& cut) {
  cut.bodies.before = nullptr;
  if (memory_.size() < kMostMemory) memory_.push_back(std::move(cut.bodies));
}

void Cuts::clear() {
  cuts_.clear();
  memory_.clear();
}

core::ChangedState Cuts::take_memory() {
  if (memory_.empty()) return {};
  core::ChangedState memory = std::move(memory_.back());
  memory_.pop_back();
  return memory;
}

core::Redo Cuts::plan(std::span<const core::Alarm> alarms, std::vector<core::TogetherPair> together) {
  const core::Step first = std::ranges::min(alarms, {}, &core::Alarm::step).step;
  std::size_t farther = 0;
  bool is_for_static = false;
  for (const core::Alarm& alarm : alarms) {
    if (!core::is_about_a_pair(alarm)) {
      is_for_static = true;
      continue;
    }
    const core::Step until = alarm.step + core::horizon::together_after_touch(lookahead_);
    const auto known = std::ranges::find_if(together, [&](const auto& pair) { return same_pair(pair, alarm); });
    if (known == together.end()) {
      together.push_back({alarm.a, alarm.b, until});
    } else {
      if (alarm.step == first && known->until >= alarm.step) farther = stubborn_ + 1;
      known->until = std::max(known->until, until);
    }
  }
  stubborn_ = std::min(farther, kMostStubborn);
  const core::Step cut = before(first, stubborn_).step;
  std::erase_if(together, [cut](const core::TogetherPair& pair) { return pair.until < cut; });
  std::ranges::sort(together, {}, [](const core::TogetherPair& pair) { return std::pair(pair.a, pair.b); });
  return {cut, 0, is_for_static, std::move(together)};
}

Cut& Cuts::back_to(core::Step step) {
  for (; !cuts_.empty() && cuts_.back().step > step; cuts_.pop_back()) drop(cuts_.back());
  if (cuts_.empty() || cuts_.back().step != step) {
    throw std::logic_error("there is no cut of state " + std::to_string(step));
  }
  return cuts_.back();
}

void SavedStates::end_with(core::Step last) {
  if (const auto ends = end(); ends && *ends <= last) return;
  forget_end();
  states_.push_back({last, {}, false, true});
}

std::optional<core::Step> SavedStates::end() const {
  const auto end = std::ranges::find_if(states_, &State::is_the_end);
  return end == states_.end() ? std::nullopt : std::optional(end->step);
}

const Cut* SavedStates::end_cut(core::Step last) const {
  const auto end = std::ranges::find_if(
      states_, [last](const State& state) { return state.is_the_end && state.step == last && state.cut; });
  return end == states_.end() ? nullptr : &*end->cut;
}

void SavedStates::forget_end() {
  std::erase_if(states_, [](const State& state) { return state.is_the_end; });
}

void SavedStates::take(core::Step step, const std::function<Cut()>& cut) {
  for (State& state : states_) {
    if (state.step == step && !state.is_confirmed) state.cut = cut();
  }
}

void SavedStates::note_arrival(const core::Adoption& adoption) {
  for (State& state : states_) {
    if (state.cut) state.cut->note_arrival(adoption);
  }
}

void SavedStates::note_spawn(const core::Order& order) {
  for (State& state : states_) {
    if (state.cut) state.cut->to_be_born.spawns.push_back(order);
  }
}

void SavedStates::note_whole(const std::function<bool(core::Step)>& is_whole) {
  for (State& state : states_) state.is_whole = state.cut && is_whole(state.step);
}

void SavedStates::put_back(core::Step step, core::Step confirmed) {
  for (State& state : states_) {
    state.is_confirmed = state.is_confirmed || state.step <= confirmed;
    if (state.step <= step || state.is_confirmed) continue;
    state.cut.reset();
    state.is_whole = false;
  }
}

std::vector<Cut> SavedStates::take_whole(core::Step confirmed) {
  std::vector<Cut> whole;
  std::erase_if(states_, [&](State& state) {
    if (state.is_the_end || !state.is_whole || !state.cut) return false;
    if (confirmed < state.step && !state.is_confirmed) return false;
    whole.push_back(std::move(*state.cut));
    return true;
  });
  return whole;
}

}  // namespace aurasim::node
