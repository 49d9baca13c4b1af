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
  held_.clear();
}

void ObservationPublisher::put_back(core::Step step, core::Step confirmed) {
  held_.put_back(step, confirmed);
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
    held_.clear();
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
  hold_made_up(node, report);
  hold_present_state(node);
  held_.give_out(node.shown_step());
}

/// Composes the present state for all observers that want it.
void ObservationPublisher::hold_present_state(node::Node& node) {
  const core::Step step = node.current_step();
  for (const dds::ObservationServer::Asked& asked : server_.asked()) {
    if (!asked.interest->is_for(step)) continue;
    Served& served = served_[asked.key];
    const State now{asked.arrivals, settings_.generation, node.redos(), step};
    const State& last = served.published.state;
    const bool has_it = last.arrivals == now.arrivals && last.generation == now.generation && last.step >= step;
    if (has_it || !served.pace.is_for(step, asked.interest->every)) continue;
    auto give = [this, key = asked.key, now, observation = compose(node, *asked.interest)]() mutable {
      ObserverPace& pace = served_[key].pace;
      if (publish(key, now, observation)) {
        pace.note_sent();
      } else {
        pace.note_too_slow();
      }
    };
    held_.add(step, std::move(give));
  }
}

void ObservationPublisher::while_paused(node::Node& node) {
  if (!look(node) || node.shown_step() < node.current_step()) return;
  held_.give_out(node.shown_step());
  for (const dds::ObservationServer::Asked& asked : server_.asked()) {
    const State now{asked.arrivals, settings_.generation, node.redos(), node.current_step()};
    if (served_[asked.key].published.state == now) continue;
    core::Observation observation = compose(node, *asked.interest);
    publish(asked.key, now, observation);
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

core::Observation ObservationPublisher::compose(node::Node& node, const core::Interest& interest) const {
  core::Observation observation =
      feed_->compose(interest, node.world().snapshot(), node.world().contact_impulses(), node.redos());
  observation.scene_order = node.newest_scene_order();
  return observation;
}

/// Publishes a state to one observer. False if it takes no more now.
bool ObservationPublisher::publish(std::uint64_t observer, const State& state, core::Observation& observation) {
  if (!server_.takes_more(observer)) return false;
  Published& published = served_[observer].published;
  const bool is_next = published.state.redo == state.redo && published.state.goes_on_with(state);
  if (is_next) observation.previous = published.state.step;
  if (!server_.send(observer, observation)) return false;
  published = {state, 0};
  return true;
}

/// Composes states that bodies which have joined late have made up.
void ObservationPublisher::hold_made_up(const node::Node& node, const node::StepReport& report) {
  for (const node::MadeUp& state : report.made_up) {
    for (const dds::ObservationServer::Asked& asked : server_.asked()) {
      if (!asked.interest->is_for(state.step)) continue;
      held_.add(state.step,
                [this, key = asked.key, observation = feed_->compose(*asked.interest, state, node.redos())] {
                  server_.send(key, observation);
                });
    }
  }
}

}  // namespace aurasim::process
