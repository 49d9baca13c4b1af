#include "process/world_gathering.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "cut/saved_world.h"

namespace aurasim::process {
namespace {

using PartKind = messages::Checkpoint::Kind;

}  // namespace

void WorldGathering::send(core::RegionId region, PartKind kind, const std::string& octets) {
  own_.checkpoints.give({region, kind, restore_.generation, restore_.at_step, octets});
}

void WorldGathering::send_parts() {
  if (is_from_first()) return;
  for (std::uint32_t r = 0; r < own_.launch.regions.size(); ++r) {
    const core::RegionId region{r};
    if (restore_.members[r].holder != own_.options.region) continue;
    if (const std::string* octets = own_.checkpoints.find(region, restore_.at_step)) {
      send(region, PartKind::kGoBack, *octets);
    }
  }
}

bool WorldGathering::has_all_parts() {
  if (is_from_first()) return true;
  return own_.checkpoints.given(restore_.generation, PartKind::kGoBack).size() >= own_.launch.regions.size();
}

void WorldGathering::send_orders() {
  if (is_from_first()) {
    whole_ = first_world();
  } else {
    parts_ = own_.checkpoints.given(restore_.generation, PartKind::kGoBack);
    std::vector<core::WorldCut> cuts;
    for (const auto& [region, octets] : parts_) cuts.push_back(decode_part(octets));
    whole_ = core::merge(std::move(cuts));
  }
  const bool survives = restore_.members.at(core::value_of(own_.options.region)).survives;
  if (!survives || own_.node == nullptr) return;
  send(own_.options.region, PartKind::kOrders, cut::encode(own_.saving.as_saved(own_.node->orders_now(whole_))));
}

bool WorldGathering::has_all_orders() {
  const auto survivors = std::ranges::count(restore_.members, true, &messages::RunCommand::Member::survives);
  return own_.checkpoints.given(restore_.generation, PartKind::kOrders).size() >= static_cast<std::size_t>(survivors);
}

core::WorldCut WorldGathering::take_world() {
  std::vector<core::WorldCut> all = {std::move(whole_)};
  for (const auto& [region, octets] : own_.checkpoints.given(restore_.generation, PartKind::kOrders)) {
    all.push_back(decode_part(octets));
  }
  return core::merge(std::move(all));
}

core::WorldCut WorldGathering::first_world() const {
  if (own_.options.world) return *own_.options.world;
  return node::first_world(own_.launch.scene, own_.launch.lookahead(), own_.launch.step_s());
}

core::WorldCut WorldGathering::decode_part(const std::string& octets) const {
  cut::SavedWorld part = cut::decode(octets);
  const std::string differs = cut::check_identity("checkpoint", part.identity, cut::identity_of(own_.launch), true);
  if (!differs.empty()) spdlog::warn("region {}: {}: bits may differ", core::value_of(own_.options.region), differs);
  return std::move(part.cut);
}

}  // namespace aurasim::process
