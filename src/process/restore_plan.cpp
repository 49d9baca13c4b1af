#include "process/restore_plan.h"

#include <algorithm>
#include <set>
#include <utility>

namespace aurasim::process {
namespace {

using Nodes = std::map<core::RegionId, messages::SeenStatus>;
using messages::NodeState;

/// True if the node stands and receives from all others. A node that does not cannot take part in the recovery: all
/// would wait for it in vain.
bool is_ready(const messages::SeenStatus& seen) {
  const bool stands = seen.status.state == NodeState::kRecovering || seen.status.state == NodeState::kSpare;
  return !seen.lost && stands && seen.status.dead.empty();
}

/// True if the node has a world of this era.
bool survives(const messages::Status& status, core::Generation era) {
  return status.state == NodeState::kRecovering && status.era == era;
}

bool keeps(const messages::Status& status, const messages::KeptPart& part) {
  return std::ranges::find(status.parts, part) != status.parts.end();
}

/// Parts that a process which has come to take a region over has found on its disk count like others.
bool gives(const messages::Status& status, core::Generation era, const messages::KeptPart& part) {
  return status.era == era && keeps(status, part);
}

/// Which node gives which region's part of this state to all. Nothing: nobody keeps one of the parts.
std::optional<std::vector<core::RegionId>> holders(const Nodes& nodes, core::Generation era, core::Step step) {
  std::vector<core::RegionId> holders;
  for (const auto& [region, seen] : nodes) {
    const messages::KeptPart part{region, step};
    const auto has_it = [&](const auto& entry) { return gives(entry.second.status, era, part); };
    const auto other = std::ranges::find_if(nodes, has_it);
    if (other == nodes.end()) return std::nullopt;
    holders.push_back(has_it(*nodes.find(region)) ? region : other->first);
  }
  return holders;
}

}  // namespace

std::optional<RestorePlan> plan_restore(const Nodes& nodes, std::size_t regions) {
  const bool all_are_ready = std::ranges::all_of(nodes, [](const auto& entry) { return is_ready(entry.second); });
  if (nodes.size() != regions || !all_are_ready) return std::nullopt;
  RestorePlan plan;
  messages::RunCommand& command = plan.command;
  command.kind = messages::RunCommandKind::kRestore;
  bool anybody = false;
  for (const auto& [region, seen] : nodes) {
    command.generation = std::max(command.generation, seen.status.generation + 1);
    if (seen.status.state == NodeState::kSpare) continue;
    command.era = anybody ? std::max(command.era, seen.status.era) : seen.status.era;
    anybody = true;
  }
  if (!anybody) return std::nullopt;
  std::set<core::Step> states;
  for (const auto& [region, seen] : nodes) {
    const messages::Status& status = seen.status;
    command.members.push_back({status.process, region, survives(status, command.era)});
    if (status.era != command.era) continue;
    for (const messages::KeptPart& part : status.parts) states.insert(part.step);
  }
  const auto lead =
      std::ranges::find_if(nodes, [&](const auto& entry) { return survives(entry.second.status, command.era); });
  plan.lead = lead->first;
  for (auto step = states.rbegin(); step != states.rend(); ++step) {
    const auto who = holders(nodes, command.era, *step);
    if (!who) continue;
    command.at_step = *step;
    for (std::size_t i = 0; i < who->size(); ++i) command.members[i].holder = (*who)[i];
    return plan;
  }
  command.count = 1;
  return plan;
}

}  // namespace aurasim::process
