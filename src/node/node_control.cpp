// What a node does with the setpoints of programs (core/control_log.h): hears them, and tells what they came to.
#include <algorithm>

#include "core/horizon.h"
#include "node/node.h"

namespace aurasim::node {
namespace {

/// States for which they are remembered: a run goes back no farther when a node has died, but for checkpoints that are
/// farther apart.
constexpr core::Step kRemembered = 600;
constexpr core::Step kForgetEvery = 30;

}  // namespace

core::Heard Node::hear(const core::Setpoints& setpoints) {
  const core::Step notice = setup_.protocol.aura.lookahead + 1;
  return world_.controls().hear(setpoints, current_step(), notice, scene_.joints.size());
}

/// Whoever has come was told of in other states by others: all that is in effect on it is told anew.
void Node::note_effects() {
  const core::ControlLog& controls = world_.controls();
  if (controls.empty()) return;
  const core::Step n = current_step();
  // What has been in effect on a body since it has come, or what is new.
  const auto is_told = [&](core::BodyId id, core::Step step, bool is_new) {
    const auto row = std::ranges::find(report_.arrivals, id, &HandOffRow::body);
    const bool has_come = row != report_.arrivals.end();
    const bool is_news = has_come ? step == row->stamp + 1 || (step > row->stamp && is_new) : step == n && is_new;
    return is_news && world_.contains(id);
  };
  core::Step oldest = n;
  for (const HandOffRow& row : report_.arrivals) oldest = std::min(oldest, row.stamp + 1);
  for (core::Step step = oldest; step <= n; ++step) {
    controls.for_each_body(step, [&](core::BodyId id, core::Quantity quantity, const auto& value, bool is_new) {
      if (is_told(id, step, is_new)) report_.effects.bodies.push_back({step, {id, quantity, value}});
    });
    controls.for_each_joint(step, [&](core::JointId id, const auto& drive, bool is_new) {
      const core::BodyId body = scene_.joints[core::value_of(id)].a;
      if (is_told(body, step, is_new)) report_.effects.joints.push_back({step, {id, drive}});
    });
  }
}

/// Its next host may have heard less. Drives of joints go along.
void Node::note_left_behind(const core::ClusterState& cluster) {
  const core::ControlLog& controls = world_.controls();
  if (controls.empty()) return;
  const core::Step n = current_step();
  const auto has_left = [&](core::BodyId id) {
    return std::ranges::binary_search(cluster.bodies, id, {}, &core::BodyRecord::id);
  };
  controls.for_each_body(n, [&](core::BodyId id, core::Quantity quantity, const auto& value, bool) {
    if (value && has_left(id)) report_.effects.bodies.push_back({n + 1, {id, quantity, {}}});
  });
}

void Node::forget_setpoints() {
  const core::Step n = current_step();
  if (n % kForgetEvery != 0) return;
  const core::Step oldest_cut = cuts_.empty() ? n : cuts_.front().step;
  world_.controls().forget_before(std::min(oldest_cut, n - kRemembered));
}

}  // namespace aurasim::node
