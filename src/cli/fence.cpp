#include "cli/fence.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kLookEvery = 50ms;

node::Quorum quorum_of(const FenceSettings& settings) {
  return {settings.region, settings.regions, settings.recovers ? node::Losses::kComeBack : node::Losses::kForgotten};
}

}  // namespace

Fence::Fence(const FenceSettings& settings, Senses senses)
    : settings_(settings), senses_(std::move(senses)), quorum_(quorum_of(settings)) {}

void Fence::begin_anew(bool recovers) {
  settings_.recovers = recovers;
  quorum_ = quorum_of(settings_);
  standing_ = node::Standing::kGoOn;
  watches_closely_ = false;
  dead_ = 0;
}

bool Fence::open(bool held_for_dead, const std::vector<core::RegionId>& dead, Clock::time_point now) {
  if (closed() || settings_.regions == 1) return !closed();
  reason_ = why_stop(held_for_dead, dead, now);
  if (closed()) return false;
  return standing_ == node::Standing::kGoOn || settings_.never_waits;
}

std::string Fence::why_stop(bool held_for_dead, const std::vector<core::RegionId>& dead, Clock::time_point now) {
  const std::uint32_t self = core::value_of(settings_.region);
  if (held_for_dead) {
    return fmt::format("a neighbour holds region {} for dead; its bodies have other hosts", self);
  }
  // A host that stands still as a whole holds all nodes up alike: then nobody is lost.
  if (!dead.empty() && !settings_.recovers && senses_.was_held_up()) {
    return fmt::format(
        "region {} was held up for longer than its participant's lease, and has lost neighbours since: they have given "
        "it up",
        self);
  }
  if (settings_.can_be_cut) look(dead, now);
  // With `recovers` nobody takes this region over but with the majority, so this node may wait for the others for ever.
  if (!is_cut_off() || settings_.recovers) return {};
  std::vector<std::uint32_t> silent;
  for (const core::RegionId lost : quorum_.lost()) silent.push_back(core::value_of(lost));
  return fmt::format(
      "region {} hears nothing from regions [{}], half of the run or more: they may have died, or this host is cut off "
      "and they go on without it",
      self, fmt::join(silent, ", "));
}

/// A neighbour's death lets the node compute at once, so a new one is looked at before that. While the node stands
/// nothing is computed: then a neighbour whose stream has ended is lost only as long as its status is not heard, since
/// its stream begins anew only after the recovery.
void Fence::look(const std::vector<core::RegionId>& dead, Clock::time_point now) {
  if (now < next_look_ && dead.size() == dead_ && !watches_closely_) return;
  next_look_ = now + kLookEvery;
  dead_ = dead.size();
  std::map<core::RegionId, node::PeerSign> signs = senses_.peers();
  if (!watches_closely_ || !settings_.recovers) {
    for (const core::RegionId region : dead) signs[region].lost = true;
  }
  standing_ = quorum_.judge(signs, now);
}

}  // namespace aurasim::cli
