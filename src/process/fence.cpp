#include "process/fence.h"

#include <utility>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kLookEvery = 50ms;

}  // namespace

Fence::Fence(const FenceSettings& settings, Peers peers)
    : settings_(settings), peers_(std::move(peers)), quorum_(settings.region, settings.regions) {}

void Fence::begin_anew() {
  quorum_ = {settings_.region, settings_.regions};
  standing_ = node::Standing::kGoOn;
  watches_closely_ = false;
  dead_ = 0;
}

bool Fence::open(const std::vector<core::RegionId>& dead, Clock::time_point now) {
  if (closed() || settings_.regions == 1) return !closed();
  if (settings_.can_be_cut) look(dead, now);
  return standing_ == node::Standing::kGoOn || settings_.never_waits;
}

/// Judges the signs of the others. A neighbour's death lets the node compute at once, so a new death is judged before
/// that. While the node waits nothing is computed. Then a neighbour whose stream has ended is lost only as long as its
/// status does not come, because its stream begins anew only after the recovery.
void Fence::look(const std::vector<core::RegionId>& dead, Clock::time_point now) {
  if (now < next_look_ && dead.size() == dead_ && !watches_closely_) return;
  next_look_ = now + kLookEvery;
  dead_ = dead.size();
  std::map<core::RegionId, node::PeerSign> signs = peers_();
  if (!watches_closely_) {
    for (const core::RegionId region : dead) signs[region].lost = true;
  }
  standing_ = quorum_.judge(signs, now);
}

}  // namespace aurasim::process
