// The rows of a node's report that follow from what has come, gone and been made up.
#include <algorithm>
#include <utility>

#include "node/node.h"

namespace aurasim::node {

void Node::note_removals() {
  report_.removals = world_.take_removed();
  for (const std::uint64_t request : world_.take_applied()) report_.applied.push_back({request, current_step(), {}});
  report_.declined = world_.take_declined();
  report_.unbearable = world_.take_unbearable();
}

void Node::clear_report() {
  report_.put_back_from.reset();
  report_.put_back_for.clear();
  report_.put_back_for_static = false;
  report_.durations = {};
  report_.departures.clear();
  report_.departed.clear();
  report_.let_go.clear();
  report_.arrivals.clear();
  report_.made_up.clear();
  report_.collisions.clear();
  report_.hash.clear();
  report_.births.clear();
  report_.removals.clear();
  report_.orders.clear();
  report_.applied.clear();
  report_.declined.clear();
  report_.effects = {};
  report_.unbearable = 0;
}

/// Adds the contacts of the made-up states that have just been reported, in the order of these states.
void Node::note_made_up_contacts() {
  std::vector<physics::MadeUpContacts> contacts = world_.take_made_up_contacts();
  const std::size_t first = report_.made_up.size() - std::min(report_.made_up.size(), contacts.size());
  for (std::size_t i = 0; first + i < report_.made_up.size(); ++i) {
    report_.made_up[first + i].contacts = std::move(contacts[i].contacts);
  }
}

void Node::note_arrivals(const core::Adoption& adoption) {
  for (const core::BodyRecord& body : adoption.cluster.bodies) {
    HandOffRow& row = report_.arrivals.emplace_back();
    row.stamp = adoption.stamp;
    row.joined = current_step() + 1;
    row.body = body.id;
    row.epoch = body.epoch;
    row.source = adoption.source;
    row.destination = region();
    row.reason = adoption.reason;
  }
  if (!protocol_->computes_again()) watch_.join(adoption);  // else nobody looks for late collisions
}

/// Reports the bodies that coupled regions have handed over at the beginning of the step.
void Node::note_moved() {
  const auto row_of = [this](const physics::Moved& moved) {
    HandOffRow row;
    row.stamp = current_step() - 1;
    row.body = moved.body.id;
    row.reason = core::HandOffReason::kBoundaryTraversal;
    return row;
  };
  for (const physics::Moved& moved : world_.left()) {
    HandOffRow& row = report_.departures.emplace_back(row_of(moved));
    row.epoch = moved.body.epoch + 1;
    row.source = region(), row.destination = moved.other;
    row.touched = touches_.take(moved.body.id);
    report_.departed.push_back(moved.body);
    note_left_behind({&moved.body, 1}, row.stamp);
  }
  for (const physics::Moved& moved : world_.arrived()) {
    HandOffRow& row = report_.arrivals.emplace_back(row_of(moved));
    row.joined = current_step();
    row.epoch = moved.body.epoch;
    row.source = moved.other, row.destination = region();
  }
}

/// Where a coupled step has not ended, the snapshot is that of the state before it. Bodies that changed hosts in this
/// step are with the old or the new one, depending on which of the two has ended it.
BodiesAtEnd Node::bodies_at_end() {
  BodiesAtEnd end;
  end.here = world_.snapshot().bodies;
  const auto add = [&end](const core::BodyRecord& body) { end.under_way.push_back(core::state_of(body)); };
  if (!settled_) {
    for (const core::HandOff& h : protocol_->departures().open()) std::ranges::for_each(h.cluster.bodies, add);
  }
  if (!is_broken_) return end;
  for (const physics::Moved& moved : world_.left()) {
    add(moved.body);
    std::erase_if(end.here, [&](const core::BodyState& body) { return body.id == moved.body.id; });
  }
  for (const physics::Moved& moved : world_.arrived()) add(moved.body);
  return end;
}

void Node::count(const core::Snapshot& snapshot) {
  report_.step = snapshot.step;
  report_.bodies = snapshot.born;
  report_.awake = snapshot.awake;
}

}  // namespace aurasim::node
