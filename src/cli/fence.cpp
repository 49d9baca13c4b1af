#include "cli/fence.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kLookEvery = 50ms;

}  // namespace

Fence::Fence(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control,
             core::RegionId region)
    : region_(region),
      alone_(launch.regions.size() == 1),
      can_be_cut_(!alone_ && !participant.stays_on_this_host()),
      never_waits_(launch.time.sync == core::SyncMode::kFreeRunning),
      participant_(participant),
      control_(control),
      quorum_(region, static_cast<std::uint32_t>(launch.regions.size())) {}

bool Fence::open(const core::Protocol& protocol) {
  if (closed() || alone_) return !closed();
  reason_ = why_stop(protocol);
  if (closed()) return false;
  return standing_ == node::Standing::kGoOn || never_waits_;
}

std::string Fence::why_stop(const core::Protocol& protocol) {
  if (protocol.fenced()) {
    return fmt::format("a neighbour holds region {} for dead; its bodies have other hosts", core::value_of(region_));
  }
  // A host that stands still as a whole holds all nodes up alike: then nobody is lost.
  if (participant_.outlived_its_lease() && !protocol.intake().dead_regions().empty()) {
    return fmt::format(
        "region {} was held up for longer than its participant's lease, and has lost neighbours since: they have given "
        "it up",
        core::value_of(region_));
  }
  if (can_be_cut_) look(protocol);
  if (standing_ != node::Standing::kCutOff) return {};
  std::vector<std::uint32_t> silent;
  for (const core::RegionId lost : quorum_.lost()) silent.push_back(core::value_of(lost));
  return fmt::format(
      "region {} hears nothing from regions [{}], half of the run or more: they may have died, or this host is cut off "
      "and they go on without it",
      core::value_of(region_), fmt::join(silent, ", "));
}

/// A neighbour's death lets the node compute at once: so whoever is newly dead is looked at before that.
void Fence::look(const core::Protocol& protocol) {
  const std::vector<core::RegionId> dead = protocol.intake().dead_regions();
  const auto now = Clock::now();
  if (now < next_look_ && dead.size() == dead_) return;
  next_look_ = now + kLookEvery;
  dead_ = dead.size();
  std::map<core::RegionId, node::PeerSign> signs;
  for (const auto& [region, seen] : control_.statuses()) {
    const bool left = seen.status.state == dds::NodeState::kFinished || seen.status.state == dds::NodeState::kFailed;
    if (region != region_) signs[region] = {seen.lost, left, seen.seen};
  }
  for (const core::RegionId region : dead) signs[region].lost = true;
  standing_ = quorum_.judge(signs, now);
}

}  // namespace aurasim::cli
