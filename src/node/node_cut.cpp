// How a node hands out its part of the world in a state (docs/design.md, "The cut").
#include <algorithm>
#include <utility>

#include "core/horizon.h"
#include "node/node.h"
#include "node/timed.h"

namespace aurasim::node {

void Node::save_if_due() {
  saved_.take(current_step(), [this] {
    const Timed timed(report_.durations.cut_s, setup_.clock);
    return cut();
  });
}

std::function<bool(core::Step)> Node::whole_by(core::Step now) const {
  return
      [this, now](core::Step state) { return now >= state + setup_.protocol.aura.lookahead && has_all_until(state); };
}

/// Makes a part of a saved world. It contains the orders known when the part is complete, and all that they have made.
core::WorldCut Node::part_of_world(Cut cut) const {
  core::WorldCut part;
  part.step = cut.step;
  part.births_known = cut.step + core::horizon::birth_notice(setup_.protocol.aura.lookahead);
  part.bodies = core::whole(std::move(cut.bodies));
  core::Step oldest = cut.step;
  for (core::Adoption& adoption : cut.joining) {
    oldest = std::min(oldest, adoption.stamp);
    part.under_way.push_back({adoption.stamp, std::move(adoption.cluster)});
  }
  add_orders(part, oldest);
  return part;
}

core::WorldCut Node::orders_now(const core::WorldCut& earlier) const {
  core::WorldCut part;
  part.step = earlier.step;
  part.births_known = earlier.births_known;
  core::Step oldest = earlier.step;
  for (const core::UnderWay& one : earlier.under_way) oldest = std::min(oldest, one.stamp);
  add_orders(part, oldest);
  return part;
}

/// Adds the orders that have changed the scene, and those for states later than `after`.
void Node::add_orders(core::WorldCut& part, core::Step after) const {
  part.last_order = protocol_->last_order();
  part.setpoints = world_.controls().since(after);
  scene_.add_to(part, after, protocol_->orders_to_come());
}

std::optional<core::WorldCut> Node::present_part() {
  if (!has_all_until(current_step())) return std::nullopt;
  Cut now = cut();
  for (const core::HandOff& to_come : protocol_->intake().to_come()) {
    if (to_come.stamp > current_step()) continue;
    now.joining.push_back({to_come.source, to_come.stamp, to_come.sequence, to_come.reason, to_come.cluster});
  }
  return part_of_world(std::move(now));
}

std::vector<core::WorldCut> Node::take_saved() {
  std::vector<core::WorldCut> complete;
  for (Cut& whole : saved_.take_whole(confirmed_step())) complete.push_back(part_of_world(std::move(whole)));
  return complete;
}

}  // namespace aurasim::node
