// How a node goes back to a cut and computes again (docs/design.md, "Checked, and computed again").
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "core/horizon.h"
#include "node/node.h"
#include "node/timed.h"

namespace aurasim::node {

core::Step Node::confirmed_step() const {
  if (!setup_.protocol.aura.redo) return current_step();
  return protocol_->alarms_given_up() ? protocol_->confirmed_but_for_alarms() : protocol_->confirmed();
}

core::Step Node::shown_step() const {
  return may_go_back() ? std::max(confirmed_step(), protocol_->checked_by_all()) : current_step();
}

bool Node::is_going_back() const {
  return may_go_back() && protocol_->computes_again() && (!redos_.empty() || !protocol_->alarms().standing().empty());
}

bool Node::stand() {
  take_mail();
  if (shown_step() >= current_step()) return true;
  if (!may_go_back() || is_going_back() || !has_all_until(current_step())) return false;
  if (!protocol_->stands()) begin_to_stand();
  while (const core::Outbox* const word = protocol_->next_word()) transport_->send(*word);
  return shown_step() >= current_step();
}

/// Notes the present and earlier states of bodies that join later. Neighbours need them to check these states.
void Node::begin_to_stand() {
  protocol_->begin_to_stand();
  for (const MadeUp& state : foresee()) {
    protocol_->note_to_come(state.step, lonely_worlds_, state.bodies);
    if (state.step == current_step()) ++lonely_worlds_;  // the last state of a cluster
  }
}

/// True if the run may go back to a cut. A node that is alone never does: no body is ever in two worlds.
bool Node::may_go_back() const { return setup_.protocol.aura.redo && map_->size() > 1; }

/// Keeps a cut of the present state, if the run may go back to it.
void Node::take_cut() {
  if (!may_go_back()) return;
  const Timed timed(report_.durations.cut_s, setup_.clock);
  cuts_.keep(cut(cuts_.take_memory()));
}

/// The cut of the present state. Uses `memory` for its bodies.
Cut Node::cut(core::ChangedState memory) {
  world_.copy_all(memory);
  return {current_step(), std::move(memory), {}, to_be_born_, watch_.counts()};
}

void Node::keep(core::Step last) {
  if (setup_.protocol.aura.redo) saved_.end_with(last);
}

void Node::forget_cuts() {
  if (!may_go_back()) return;
  cuts_.forget(protocol_->confirmed(), protocol_->alarms_given_up());
  if (beginning_ && cuts_.oldest() > beginning_->world.step) beginning_.reset();
}

/// Orders a redo for the standing alarms. Does nothing except on the one node that takes orders. Alarms about states
/// after the last one of the run are ignored, because other nodes may have ended by now.
///
/// A node goes back as soon as it knows of the order. Only where an earlier redo has not brought a pair together, all
/// wait for the state in which all know of it: they then keep what the regions between have learned of each other.
void Node::order_redo() {
  if (!may_go_back()) return;
  if (!protocol_->intake().dead_regions().empty()) give_up_redo();
  if (region() != core::RegionId{0} || !redos_.empty() || protocol_->alarms_given_up()) return;
  const core::Step last = saved_.end().value_or(std::numeric_limits<core::Step>::max());
  std::vector<core::Alarm> alarms;
  std::ranges::copy_if(protocol_->alarms().standing(), std::back_inserter(alarms),
                       [last](const core::Alarm& alarm) { return alarm.step <= last; });
  if (alarms.empty()) return;
  core::Redo redo = cuts_.plan(alarms, setup_.protocol.together);
  redo.confirmed = std::max(protocol_->confirmed_here(), core::Step{0});
  core::Order order;
  order.at_step = cuts_.is_stubborn() ? protocol_->earliest_agreement() : redo.cut + 1;
  order.action = std::move(redo);
  protocol_->announce(std::move(order));
  learn_of_redos();
}

/// Takes note of redos that have been ordered, before their orders are executed with the next state.
void Node::learn_of_redos() {
  for (const core::Order& order : protocol_->orders_to_come()) {
    if (order.sequence <= last_redo_ || !std::holds_alternative<core::Redo>(order.action)) continue;
    last_redo_ = order.sequence;
    redos_.push_back(order);
  }
}

/// May this node carry out the next redo? Not before it has checked all states up to the cut, because none of them is
/// checked again. And not before all clusters that left in the cut or earlier have joined, K states later at most:
/// until then the cut does not have them.
bool Node::redo_is_due() const {
  if (redos_.empty() || current_step() < redos_.front().at_step) return false;
  const core::Step cut = std::get<core::Redo>(redos_.front().action).cut;
  return current_step() >= cut + setup_.protocol.aura.lookahead && protocol_->checked() >= cut;
}

/// Goes back to the cut of the next redo. Messages under way belong to the time before it, and their receivers drop
/// them.
void Node::put_back() {
  const core::Step from = current_step();
  const core::Order order = redos_.front();
  redos_.erase(redos_.begin());
  const auto redo = std::get<core::Redo>(order.action);
  if (redo.is_for_static) statics_.note_doubt(from);
  // The same on all nodes. A body's host may be another one when a state is computed again.
  release_held(redo.confirmed);
  saved_.note_whole(whole_by(from));
  clear_report();
  gathered_ = {};
  report_.put_back_confirmed = redo.confirmed;
  report_.put_back_for_static = redo.is_for_static;
  cuts_.forget(redo.confirmed, false);  // so all nodes have the same cuts, which the next redo may need
  Cut& cut = cuts_.back_to(redo.cut);
  setup_.protocol.together = redo.pairs;
  setup_.protocol.start = cut.step;
  // Epochs must only grow, for observers too. `more` exceeds the number of times that any body can have changed host
  // since: no node is more than a round ahead of this one.
  const auto more = static_cast<core::Epoch>(from + protocol_->round() - cut.step + 1);
  first_epoch_ += more;
  const auto raise = [&](core::ClusterState& cluster) {
    for (core::BodyRecord& body : cluster.bodies) body.epoch += more;
  };
  const bool is_the_beginning = beginning_ && cut.step == beginning_->world.step;
  if (is_the_beginning) {
    cut.bodies = core::ChangedState(our_part());  // there is no time to bring a pair together later
  } else {
    cut.bodies = core::ChangedState(core::whole(std::move(cut.bodies)));
    raise(cut.bodies.now);
  }
  for (core::Adoption& adoption : cut.joining) raise(adoption.cluster);

  note_late_words(cut.step + 1, held_.released());
  core::Continuation next = protocol_->continuation(order);
  setup_.protocol.redo = next.alarms.redo();
  std::vector<core::Listened> related = next.related;
  if (is_the_beginning) related.insert(related.end(), setup_.protocol.related.begin(), setup_.protocol.related.end());
  setup_.protocol.related = std::move(related);
  protocol_.emplace(setup_.protocol, *map_, *clearance_, std::move(next));
  report_.put_back_from = from;
  report_.put_back_for = redo.pairs;
  saved_.put_back(cut.step, redo.confirmed);
  put_in(cut);
  note_effects_anew();
  begin_state(Recorded::kYes);
}

/// Sends away what another node has to host before the next state is computed.
void Node::gather() {
  std::swap(report_, gathered_);
  report_ = {};
  release(protocol_->gather(world_.snapshot()));
  std::swap(report_, gathered_);
  const Timed timed(mail_s_, setup_.clock);
  transport_->send(protocol_->outbox());
}

/// Keeps a report until its state is confirmed. A redo may go back to before a confirmed state. Such states are
/// computed again, and not reported twice.
void Node::hold() {
  held_.add(report_);
  release_held(confirmed_step());
}

/// Gives out the reports of states up to `until`, but for those after the state in which the run ends.
void Node::release_held(core::Step until) { held_.release(std::min(until, saved_.end().value_or(until))); }

std::span<const StepReport> Node::finish(core::Step last) {
  held_.begin_step();
  const Cut* const end = saved_.end_cut(last);
  settled_ = end != nullptr;
  if (settled_) {
    put_in(*end);
    note_effects_anew();
  }
  release_held(last);
  saved_.forget_end();
  held_.finish(last);
  return held_.given_out();
}

/// Confirms all states, because no redo goes back to before a change of the map.
void Node::confirm_all() {
  release_held(current_step());
  cuts_.clear();
  beginning_.reset();
  redos_.clear();
}

}  // namespace aurasim::node
