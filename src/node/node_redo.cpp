// How a node goes back to a cut and computes again (docs/design.md, "Checked, and computed again").
#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/horizon.h"
#include "node/node.h"
#include "node/timed.h"

namespace aurasim::node {
namespace {

/// Number of older cuts that are kept for pairs that one redo does not bring together.
constexpr std::size_t kOlderCuts = 4;

constexpr std::size_t kMostCuts = 40;

bool same_pair(const core::TogetherPair& pair, const core::Alarm& alarm) {
  return pair.a == alarm.a && pair.b == alarm.b;
}

}  // namespace

core::Step Node::confirmed_step() const {
  if (!setup_.protocol.aura.redo) return current_step();
  return protocol_->alarms_given_up() ? protocol_->confirmed_but_for_alarms() : protocol_->confirmed();
}

/// True if the run may go back to a cut. A node that is alone never does: no body is ever in two worlds.
bool Node::may_go_back() const { return setup_.protocol.aura.redo && map_->size() > 1; }

/// Keeps a cut of the present state, if the run may go back to it.
void Node::take_cut() {
  if (!may_go_back()) return;
  const Timed timed(report_.durations.cut_s, setup_.clock);
  cuts_.push_back(cut());
}

Cut Node::cut() const {
  return {current_step(), world_.peek_all(), {}, to_spawn_, next_injection_, protocol_->claimer(), watch_.counts()};
}

void Node::keep(core::Step last) {
  if (!setup_.protocol.aura.redo) return;
  const auto ends_before = [last](const Saving& saving) { return saving.is_the_end && saving.step <= last; };
  if (std::ranges::any_of(saving_, ends_before)) return;
  std::erase_if(saving_, [](const Saving& saving) { return saving.is_the_end; });
  saving_.push_back({last, {}, false, true});
}

/// Drops the cuts that are older than any that a redo can still go back to. All nodes go back to the same state, so no
/// node may drop its cut, or the reports since, before all have confirmed later states.
void Node::forget_cuts() {
  if (!may_go_back()) return;
  const core::Step oldest = cut_before(protocol_->confirmed() + 1, kOlderCuts).step;
  while (cuts_.front().step < oldest) cuts_.pop_front();
  if (begun_with_ && cuts_.front().step > begun_with_->step) begun_with_.reset();
  if (protocol_->alarms_given_up() && cuts_.size() > kMostCuts) cuts_.pop_front();  // an alarm may stand for ever
}

/// The newest cut early enough to bring a pair that touched in state `touch` to one host, or `farther` cuts before it.
const Cut& Node::cut_before(core::Step touch, std::size_t farther) const {
  const core::Step wanted = touch - core::horizon::before_touch(setup_.protocol.aura.lookahead);
  std::size_t newest = 0;
  while (newest + 1 < cuts_.size() && cuts_[newest + 1].step <= wanted) ++newest;
  return cuts_[newest - std::min(newest, farther)];
}

/// Orders a redo for the standing alarms. Does nothing except on the one node that takes orders.
void Node::order_redo() {
  if (!may_go_back()) return;
  const std::span<const core::Alarm> alarms = protocol_->alarms().standing();
  if (!protocol_->intake().dead_regions().empty()) give_up_redo();
  if (region() != core::RegionId{0} || redo_is_ordered_ || alarms.empty() || protocol_->alarms_given_up()) return;
  const core::Step first = std::ranges::min(alarms, {}, &core::Alarm::step).step;
  std::size_t farther = 0;
  std::vector<core::TogetherPair> pairs = setup_.protocol.together;
  for (const core::Alarm& alarm : alarms) {
    if (!core::is_about_a_pair(alarm)) continue;
    const core::Step until = alarm.step + core::horizon::together_after_touch(setup_.protocol.aura.lookahead);
    const auto known = std::ranges::find_if(pairs, [&](const auto& pair) { return same_pair(pair, alarm); });
    if (known == pairs.end()) {
      pairs.push_back({alarm.a, alarm.b, until});
    } else {
      if (alarm.step == first && known->until >= alarm.step) farther = stubborn_ + 1;
      known->until = std::max(known->until, until);
    }
  }
  stubborn_ = std::min(farther, kOlderCuts);
  const Cut& cut = cut_before(first, stubborn_);
  std::erase_if(pairs, [&](const core::TogetherPair& pair) { return pair.until < cut.step; });
  std::ranges::sort(pairs, {}, [](const core::TogetherPair& pair) { return std::pair(pair.a, pair.b); });
  core::Order order;
  order.at_step = protocol_->earliest_agreement();
  order.action = core::Redo{cut.step, std::move(pairs)};
  protocol_->announce(std::move(order));
  redo_is_ordered_ = true;
}

/// Goes back to the cut that redo_ names. All nodes do so after the same state. Messages under way belong to the old
/// redo, and their receivers drop them.
void Node::put_back() {
  const core::Step from = current_step();
  const core::Order order = *redo_;
  const auto redo = std::get<core::Redo>(order.action);
  redo_.reset();
  redo_is_ordered_ = false;
  if (!std::ranges::all_of(protocol_->alarms().standing(), core::is_about_a_pair)) doubted_.push_back(from);
  clear_report();
  while (!cuts_.empty() && cuts_.back().step > redo.cut) cuts_.pop_back();
  if (cuts_.empty() || cuts_.back().step != redo.cut) {
    throw std::logic_error("there is no cut of state " + std::to_string(redo.cut));
  }
  Cut& cut = cuts_.back();
  setup_.protocol.together = redo.pairs;
  // Epochs must only grow, for observers too. `more` exceeds the number of times that any body can have changed host
  // since.
  const auto more = static_cast<core::Epoch>(from - cut.step + 1);
  first_epoch_ += more;
  const auto raise = [&](core::ClusterState& cluster) {
    for (core::BodyRecord& body : cluster.bodies) body.epoch += more;
  };
  const bool is_the_beginning = cut.step == (begun_with_ ? begun_with_->step : 0);
  if (is_the_beginning && begun_with_) {
    cut.bodies = our_part();
  } else if (is_the_beginning) {
    cut.bodies.bodies = initial_bodies();  // there is no time to bring a pair together later
  }
  if (!is_the_beginning) raise(cut.bodies);
  for (core::Adoption& adoption : cut.joining) raise(adoption.cluster);

  note_late_words(cut.step + 1, released_);
  core::Continuation next = protocol_->continuation(order, cut.claimer);
  setup_.protocol.redo = next.alarms.redo();
  setup_.protocol.start = cut.step;
  std::vector<core::Listened> related = next.related;
  if (is_the_beginning) related.insert(related.end(), setup_.protocol.related.begin(), setup_.protocol.related.end());
  setup_.protocol.related = std::move(related);
  protocol_.emplace(setup_.protocol, *map_, *clearance_, std::move(next));
  report_.put_back_from = from;
  report_.put_back_for = redo.pairs;
  for (Saving& saving : saving_) {
    if (saving.step > cut.step) saving.cut.reset(), saving.is_whole = false;
  }
  go_back_to(cut);
  const bool hashes = std::exchange(setup_.hash_states, false);  // this state's has been reported
  finish_state();
  setup_.hash_states = hashes;
}

void Node::go_back_to(const Cut& cut) {
  world_.put_back(cut.step, cut.bodies);
  watch_.put_back(cut.collisions);
  to_spawn_ = cut.to_spawn;
  next_injection_ = cut.next_injection;
  std::uint32_t nth = 0;
  for (const core::Adoption& adoption : cut.joining) adopt(adoption, nth++);
  note_effects_anew();
}

/// Keeps a report until its state is confirmed. A redo may go back to before a confirmed state. Such states are
/// computed again, and not reported twice.
void Node::hold(StepReport report) {
  if (!setup_.protocol.aura.redo) {
    confirmed_.push_back(std::move(report));
    return;
  }
  if (report.put_back_from) {
    const auto is_later = [&](const auto& one) { return one.step > report.step; };
    std::erase_if(held_, is_later);
    std::erase_if(hash_parts_, [&](const HeldHash& one) {
      return one.told_in > report.step || (one.told_in == report.step && one.told_by_redo);
    });
  }
  for (const HashPart& part : report.hash) {
    hash_parts_.push_back({report.step, report.put_back_from.has_value(), part});
  }
  report.hash.clear();
  if (report.put_back_from || report.step > released_) held_.push_back(std::move(report));
  release_reports(confirmed_step());
}

void Node::release_reports(core::Step until) {
  for (const Saving& saving : saving_) {
    if (saving.is_the_end) until = std::min(until, saving.step);  // the run ends with this state
  }
  while (!held_.empty() && held_.front().step <= until) {
    StepReport& report = confirmed_.emplace_back(std::move(held_.front()));
    held_.pop_front();
    released_ = std::max(released_, report.step);
    // The last bodies that join for a state do so K states later.
    release_hashes(released_ - setup_.protocol.aura.lookahead, report);
  }
}

/// Gives out the hashes of states up to `until`, which nothing can join any more. Hashes given out before are left out.
void Node::release_hashes(core::Step until, StepReport& report) {
  std::erase_if(hash_parts_, [&](const HeldHash& one) {
    if (one.part.step > until) return false;
    if (one.part.step > hashed_) report.hash.push_back(one.part);
    return true;
  });
  hashed_ = std::max(hashed_, until);
}

std::span<const StepReport> Node::finish(core::Step last) {
  confirmed_.clear();
  const auto end = std::ranges::find_if(
      saving_, [last](const Saving& saving) { return saving.is_the_end && saving.step == last && saving.cut; });
  settled_ = end != saving_.end();
  if (settled_) go_back_to(*end->cut);
  release_reports(last);
  std::erase_if(saving_, [](const Saving& saving) { return saving.is_the_end; });
  // Bodies that joined later have made up their part of the last states.
  StepReport rest;
  rest.step = last;
  for (const StepReport& later : held_) {
    std::ranges::copy_if(later.arrivals, std::back_inserter(rest.arrivals),
                         [last](const HandOffRow& row) { return row.stamp <= last; });
    const auto is_of_the_run = [last](const auto& effect) { return effect.step <= last; };
    std::ranges::copy_if(later.effects.bodies, std::back_inserter(rest.effects.bodies), is_of_the_run);
    std::ranges::copy_if(later.effects.joints, std::back_inserter(rest.effects.joints), is_of_the_run);
  }
  release_hashes(last, rest);
  if (!rest.arrivals.empty() || !rest.hash.empty()) confirmed_.push_back(std::move(rest));
  held_.clear();
  hash_parts_.clear();
  return confirmed_;
}

/// Confirms all states, because no redo goes back to before a change of the map.
void Node::confirm_all() {
  release_reports(current_step());
  cuts_.clear();
  redo_.reset();
  redo_is_ordered_ = false;
}

}  // namespace aurasim::node
