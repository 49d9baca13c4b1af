#include "overseer/world_watch.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "config/launch_variants.h"
#include "core/command.h"

namespace aurasim::overseer {
namespace {

using namespace std::chrono_literals;

constexpr auto kLookPeriod = 20ms;

/// State of a region for the view. A finished node is not waited for, but its bodies stay where they are; those of a
/// dead node are removed.
WorldView::RegionState region_state(const messages::SeenStatus& seen) {
  using State = WorldView::RegionState;
  switch (seen.status.state) {
    case messages::NodeState::kRunning:
    case messages::NodeState::kPaused:
    case messages::NodeState::kRecovering:
    case messages::NodeState::kCutOff:
      return seen.lost ? State::kDead : State::kLive;
    case messages::NodeState::kFailed:
      return State::kDead;
    case messages::NodeState::kStarting:
    case messages::NodeState::kWaiting:
    case messages::NodeState::kSpare:
    case messages::NodeState::kFinished:
      return State::kAbsent;
  }
  return State::kAbsent;
}

dds::ObserverSettings settings_of(const config::Launch& launch) {
  return {launch.regions.version(), static_cast<std::uint32_t>(launch.regions.size()),
          static_cast<std::uint32_t>(launch.scene.prototypes.size() + core::kRoomForClients)};
}

}  // namespace

double view_clock_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

WorldWatch::WorldWatch(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control)
    : launch_(launch),
      agreement_(launch.agreement()),
      participant_(participant),
      control_(control),
      settings_(settings_of(launch)),
      view_settings_{.region_count = launch.regions.size(),
                     .unclaimed_patience = static_cast<core::Step>(3 * launch.time.step_hz)} {
  watch_anew();
}

/// Creates new readers, because nodes send everything that they have to new readers.
void WorldWatch::watch_anew() {
  replicas_.emplace(participant_, settings_);
  view_.emplace(view_settings_);
  published_.clear();
}

void WorldWatch::look(std::chrono::nanoseconds time_out) {
  replicas_->wait(time_out);
  look_at_nodes();
  look_at_map();
  for (core::Replica& replica : replicas_->take()) {
    note(replica);
    view_->accept(std::move(replica), view_clock_s());
  }
}

void WorldWatch::note(const core::Replica& replica) {
  Published& known = published_[replica.source];
  if (replica.generation != known.generation) known = {replica.generation, -1};
  if (!replica.key_frame) known.step = replica.stamp;
}

core::Step WorldWatch::published(core::RegionId region, core::Generation generation) const {
  const auto known = published_.find(region);
  return known != published_.end() && known->second.generation == generation ? known->second.step : -1;
}

/// True when the same regions are run by other processes in no later generation: the former world is gone. A process
/// that takes over a region continues it in a later generation.
bool WorldWatch::run_was_restarted() {
  bool restarted = false;
  for (const auto& [region, seen] : nodes_) {
    const messages::Status& status = seen.status;
    const auto [known, is_first] = pids_.try_emplace(region, status.pid);
    const bool begins_anew = status.generation == 0 || status.generation < view_->generation();
    if (known->second == status.pid || status.state == messages::NodeState::kSpare) continue;
    known->second = status.pid;
    restarted = restarted || begins_anew;
  }
  return restarted;
}

void WorldWatch::look_at_nodes() {
  if (Clock::now() < next_look_) return;
  next_look_ = Clock::now() + kLookPeriod;
  nodes_.clear();
  for (const auto& [region, seen] : control_.statuses()) {
    const bool is_ours = seen.status.agreement == agreement_ && core::value_of(region) < launch_.regions.size();
    if (is_ours) nodes_.emplace(region, seen);
  }
  if (run_was_restarted()) watch_anew();
  for (const auto& [region, seen] : nodes_) view_->set_region(region, region_state(seen));
}

void WorldWatch::look_at_map() {
  const messages::WorldMap* newest = nullptr;
  for (const auto& [version, map] : control_.maps()) {
    const bool ours = map.agreement == agreement_ && map.generation > map_generation_;
    if (ours && (newest == nullptr || map.generation > newest->generation)) newest = &map;
  }
  if (newest == nullptr) return;
  map_generation_ = newest->generation;
  try {
    config::Launch changed = launch_;
    if (newest->scene != launch_.scene.name) changed = config::with_scene(changed, newest->scene);
    if (newest->map_version != launch_.regions.version()) changed = config::with_regions(changed, newest->regions);
    launch_ = std::move(changed);
  } catch (const config::BadConfig& error) {
    return spdlog::error("the run has changed to what cannot be read here: {}", error.what());
  }
  settings_ = settings_of(launch_);
  watch_anew();
  changed_ = true;
}

}  // namespace aurasim::overseer
