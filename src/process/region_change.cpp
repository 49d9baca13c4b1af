#include "process/region_change.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/launch_variants.h"
#include "setup/launch_setup.h"

namespace aurasim::process {

RegionChange::RegionChange(const config::Launch& launch, const std::vector<core::Rectangle>& boxes,
                           core::RegionId region, core::Generation generation)
    : launch_(config::with_regions(launch, boxes)),
      settings_{region, generation + 1, setup::aura_rules(launch_), &launch_.regions} {}

void RegionChange::begin_census(NodeEndpoints& endpoints, node::Node& node) {
  endpoints.observers().use_map(launch_.regions.version());  // so that observers of the old map do not receive it
  endpoints.observers().publish_census(node, settings_.census);
  dds::ObserverSettings watched;
  watched.map_version = launch_.regions.version();
  watched.region_count = static_cast<std::uint32_t>(launch_.regions.size());
  watched.prototype_count = static_cast<std::uint32_t>(node.scene().prototypes.size());
  reader_ = std::make_unique<dds::ReplicaReader>(endpoints.participant(), watched);
  census_.emplace(settings_, node.current_step());
}

void RegionChange::receive_census(std::chrono::nanoseconds time_out) {
  reader_->wait(time_out);
  for (const core::Replica& replica : reader_->take()) census_->accept(replica);
}

void RegionChange::end_census(const node::Node& node) {
  departures_ = node::find_new_hosts(settings_, census_->take(), node);
  reader_.reset();
}

std::string RegionChange::missing_in_census() const {
  return fmt::format("new regions: regions {} have not published the bodies that they host", census_->silent());
}

dds::TransportSettings RegionChange::transport_to_all() const {
  dds::TransportSettings settings = neighbour_transport(launch_, settings_.region);
  settings.neighbours.clear();
  for (std::uint32_t r = 0; r < launch_.regions.size(); ++r) {
    if (core::RegionId{r} != settings_.region) settings.neighbours.push_back(core::RegionId{r});
  }
  return settings;
}

void RegionChange::begin_exchange(dds::DdsTransport& transport, node::Node& node) {
  exchange_.emplace(settings_, departures_, transport, node);
}

std::string RegionChange::missing_in_exchange() const {
  return fmt::format("new regions: regions {} have not sent their bodies", exchange_->silent());
}

node::StepReport RegionChange::finish(const node::Node& node) {
  node::StepReport moved;
  moved.step = node.current_step();
  for (const node::HandOffRow& row : exchange_->finish()) {
    (row.source == settings_.region ? moved.departures : moved.arrivals).push_back(row);
  }
  return moved;
}

}  // namespace aurasim::process
