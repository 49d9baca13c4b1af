#include "process/node_endpoints.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/nearness.h"
#include "core/seam_tree.h"
#include "host/heartbeat.h"
#include "physics/coupling.h"
#include "setup/guard_log.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"

namespace aurasim::process {
namespace {

void log_impairment(const dds::Participant& participant) {
  const auto report = participant.impairment();
  if (!report) return;
  const auto& [by, datagrams] = *report;
  spdlog::info(
      "impaired network: delay {:.3g} ms, jitter {:.3g} ms, loss {:.3g}, bandwidth {}, reorder {}, "
      "discovery {}, seed {}; datagrams passed {}, delayed {}, lost {}, overflowed {}, still queued {}",
      1e3 * by.delay_s, 1e3 * by.jitter_s, by.loss,
      by.bandwidth_B_s > 0 ? fmt::format("{:.4g} B/s", by.bandwidth_B_s) : "unlimited", by.reorder, by.discovery,
      by.seed, datagrams.passed, datagrams.delayed, datagrams.lost, datagrams.overflowed, datagrams.queued);
}

/// DDS settings of a node. A launcher on this host that receives the heartbeat knows which of its processes live, and
/// ends those that hang; then nothing else judges that.
dds::Settings settings_of_node(const config::Launch& launch, const NodeOptions& options) {
  dds::Settings settings = setup::with_keys(setup::dds_settings(launch, options.region), launch,
                                            setup::member_for_node(launch, options.as, options.region));
  const bool is_watched = options.has_launcher && options.heartbeat >= 0;
  settings.believes_silence = !is_watched;
  settings.announces_types = options.region == core::RegionId{0};
  settings.show_life = [heartbeat = host::Heartbeat(options.heartbeat)] { heartbeat.beat(); };
  return settings;
}

}  // namespace

dds::TransportSettings neighbour_transport(const config::Launch& launch, core::RegionId region) {
  dds::TransportSettings settings;
  settings.region = region;
  settings.map_version = launch.regions.version();
  settings.region_count = static_cast<std::uint32_t>(launch.regions.size());
  settings.prototype_count = static_cast<std::uint32_t>(launch.scene.prototypes.size() + core::kRoomForClients);
  settings.static_count = static_cast<std::uint32_t>(launch.scene.statics.size() + core::kRoomForClients);
  settings.joint_count = static_cast<std::uint32_t>(launch.scene.joints.size() + core::kRoomForClients);
  settings.coupled = launch.is_coupled();
  std::optional<core::BlockOwners> owners;
  if (settings.coupled)
    owners.emplace(physics::block_owners(launch.regions, launch.scene, setup::physics_settings(launch)));
  const core::Nearness nearness(setup::listening_distance_m(launch), owners ? &*owners : nullptr);
  settings.neighbours = core::regions_near(launch.regions, nearness, region);
  if (owners) {
    settings.near = settings.neighbours;
    // Few regions all listen to each other, and post parcels to those near them only.
    if (!core::SeamTree(owners->size()).is_needed())
      std::erase_if(settings.near, [&](core::RegionId other) { return !owners->are_near(region, other); });
  }
  settings.block_m = launch.block_m();
  return settings;
}

NodeEndpoints::NodeEndpoints(const config::Launch& launch, const NodeOptions& options)
    : launch_(launch),
      options_(options),
      participant_(std::make_unique<dds::Participant>(settings_of_node(launch, options))),
      control_(*participant_, {launch.regions.version(), options.region, launch.agreement(), options.run,
                               static_cast<std::uint32_t>(launch.regions.size())}) {}

void NodeEndpoints::open(const dds::TransportSettings& settings) {
  transport_.emplace(*participant_, settings);
  serve_map();
  open_ros2();
  open_checkpoints();
}

void NodeEndpoints::open_checkpoints() { checkpoints_.emplace(*participant_, options_.region); }

void NodeEndpoints::open_ros2() {
  if (launch_.ros2.on && !ros2_) ros2_.emplace(launch_, options_.region);
}

void NodeEndpoints::connect(const dds::TransportSettings& settings) {
  transport_.reset();
  transport_.emplace(*participant_, settings);
}

void NodeEndpoints::serve_map() {
  if (observers_ && command_server_ && programs_ && served_map_ == launch_.regions.version()) return;
  observers_.emplace(launch_, *participant_, options_.region);
  command_server_.emplace(launch_, *participant_, options_.region, options_.saves);
  programs_.emplace(*participant_);
  note_served_map();
}

void NodeEndpoints::join_anew(const dds::TransportSettings& settings) {
  auto anew = std::make_unique<dds::Participant>(participant_->settings());
  ros2_.reset();
  programs_.reset();
  control_.move_to(*anew);
  checkpoints_->move_to(*anew);
  if (observers_) observers_.emplace(launch_, *anew, options_.region);
  if (command_server_) command_server_.emplace(launch_, *anew, options_.region, options_.saves);
  if (transport_) transport_.emplace(*anew, settings);
  participant_ = std::move(anew);
  programs_.emplace(*participant_);
  open_ros2();
}

void NodeEndpoints::flush() {
  participant_->flush_delayed();
  log_impairment(*participant_);
  setup::log_refusals(*participant_);
}

std::vector<core::Setpoints> NodeEndpoints::take_setpoints(core::Generation generation) {
  std::vector<core::Setpoints> received = programs_->take(generation);
  if (ros2_) std::ranges::move(ros2_->take(generation), std::back_inserter(received));
  return received;
}

std::uint64_t NodeEndpoints::refused_setpoints() const { return programs_->refused() + (ros2_ ? ros2_->refused() : 0); }

void NodeEndpoints::publish_ros2(node::Node& node, core::Generation generation) {
  if (ros2_) ros2_->publish(node, generation, leads());
}

void NodeEndpoints::put_back(core::Step step, core::Step confirmed) {
  observers_->put_back(step, confirmed);
  if (ros2_) ros2_->put_back(step, confirmed);
}

std::map<core::RegionId, node::PeerSign> NodeEndpoints::peer_signs() {
  std::map<core::RegionId, node::PeerSign> signs;
  for (std::uint32_t r = 0; r < launch_.regions.size(); ++r) {
    if (core::RegionId{r} != options_.region) signs[core::RegionId{r}].lost = true;
  }
  for (const auto& [region, seen] : control_.statuses()) {
    const bool left = seen.dead || seen.has_ended();
    if (region != options_.region) signs[region] = {seen.lost, left, seen.seen};
  }
  return signs;
}

bool NodeEndpoints::leads() {
  return std::ranges::none_of(control_.statuses(), [this](const auto& entry) {
    return entry.first < options_.region && entry.second.is_live();
  });
}

}  // namespace aurasim::process
