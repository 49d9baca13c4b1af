#include "process/observation_publisher.h"

#include <algorithm>
#include <utility>

namespace aurasim::process {

ObservationPublisher::ObservationPublisher(const config::Launch& launch, dds::Participant& participant,
                                           core::RegionId region)
    : settings_{region, 0, launch.regions.version(), launch.lookahead()}, server_(participant, region) {}

void ObservationPublisher::begin_generation(core::Generation generation, std::uint64_t map_version) {
  settings_.generation = generation;
  settings_.map_version = map_version;
  feed_.reset();
}

/// Takes in observers' requests. False if there are none. The node sums up contacts for observers from its next step
/// on.
bool ObservationPublisher::look(node::Node& node) {
  server_.look();
  if (!server_.anybody_asks()) {
    if (is_observed_) node.observe(false, false);
    is_observed_ = false;
    feed_.reset();
    served_.clear();
    return false;
  }
  const bool wants_contacts = std::ranges::any_of(
      server_.asked(), [](const dds::ObservationServer::Asked& asked) { return asked.interest->contacts; });
  node.observe(true, wants_contacts);
  is_observed_ = true;
  if (!feed_) {
    feed_.emplace(settings_, node.scene());
    feed_->begin(node.current_step(), node.protocol().departures().open());
  }
  return true;
}

void ObservationPublisher::after_step(node::Node& node, const node::StepReport& report) {
  if (!look(node)) return;
  feed_->note(report, node.protocol().departures().open());
  publish_made_up(node, report);
  for (const dds::ObservationServer::Asked& asked : server_.asked()) {
    if (!asked.interest->is_for(report.step)) continue;
    ObserverPace& pace = served_[asked.key].pace;
    if (!pace.is_for(report.step, asked.interest->every)) continue;
    if (publish(node, asked)) {
      pace.note_sent();
    } else {
      pace.note_too_slow();
    }
  }
}

void ObservationPublisher::while_paused(node::Node& node) {
  if (!look(node)) return;
  for (const dds::ObservationServer::Asked& asked : server_.asked()) {
    const State now{asked.arrivals, settings_.generation, node.redos(), node.current_step()};
    if (served_[asked.key].published.state != now) publish(node, asked);
  }
  publish_foreseen(node);
}

/// Publishes states of bodies that are under way to this node. Usually they are made up when the bodies join; in a
/// paused run the bodies have not joined yet.
void ObservationPublisher::publish_foreseen(node::Node& node) {
  std::optional<std::vector<node::MadeUp>> foreseen;
  for (const dds::ObservationServer::Asked& asked : server_.asked()) {
    Published& published = served_[asked.key].published;
    if (std::exchange(published.hand_offs, node.hand_offs_to_come()) == node.hand_offs_to_come()) continue;
    if (!foreseen) foreseen = node.foresee();
    for (const node::MadeUp& state : *foreseen) {
      const bool is_wanted = asked.interest->is_for(state.step) || state.step == node.current_step();
      if (is_wanted) server_.send(asked.key, feed_->compose(*asked.interest, state, node.redos()));
    }
  }
}

bool ObservationPublisher::publish(node::Node& node, const dds::ObservationServer::Asked& asked) {
  if (!server_.takes_more(asked.key)) return false;
  Published& published = served_[asked.key].published;
  const State now{asked.arrivals, settings_.generation, node.redos(), node.current_step()};
  core::Observation observation =
      feed_->compose(*asked.interest, node.world().snapshot(), node.world().contact_impulses(), node.redos());
  observation.scene_order = node.newest_scene_order();
  const bool goes_on = published.state.arrivals == now.arrivals && published.state.generation == now.generation &&
                       published.state.redo == now.redo;
  if (goes_on && published.state.step < now.step) observation.previous = published.state.step;
  if (!server_.send(asked.key, observation)) return false;
  published = {now, 0};
  return true;
}

void ObservationPublisher::publish_made_up(const node::Node& node, const node::StepReport& report) {
  for (const node::MadeUp& state : report.made_up) {
    for (const dds::ObservationServer::Asked& asked : server_.asked()) {
      if (asked.interest->is_for(state.step)) {
        server_.send(asked.key, feed_->compose(*asked.interest, state, node.redos()));
      }
    }
  }
}

}  // namespace aurasim::process
