#include "process/step_back.h"

#include <algorithm>

namespace aurasim::process {
namespace {

bool computes(const messages::SeenStatus& seen) {
  const messages::NodeState state = seen.status.state;
  return seen.is_live() && (state == messages::NodeState::kRunning || state == messages::NodeState::kPaused);
}

}  // namespace

std::optional<messages::RunCommand> plan_step_back(const std::map<core::RegionId, messages::SeenStatus>& nodes,
                                                   std::size_t regions, core::Step latest) {
  if (nodes.empty() || nodes.size() != regions) return std::nullopt;
  const messages::Status& first = nodes.begin()->second.status;
  messages::RunCommand command;
  command.kind = messages::RunCommandKind::kRestore;
  command.era = first.era;
  for (const auto& [region, seen] : nodes) {
    if (!computes(seen) || seen.status.era != first.era || seen.status.generation != first.generation) {
      return std::nullopt;
    }
    command.members.push_back({seen.status.process, region, false});
  }
  command.generation = first.generation + 1;
  const auto all_keep = [&nodes](core::Step step) {
    return std::ranges::all_of(nodes, [step](const auto& entry) {
      const messages::KeptPart own{entry.first, step};
      return std::ranges::find(entry.second.status.parts, own) != entry.second.status.parts.end();
    });
  };
  std::optional<core::Step> newest;
  for (const messages::KeptPart& part : first.parts) {
    if (part.step <= latest && part.step > newest.value_or(-1) && all_keep(part.step)) newest = part.step;
  }
  if (!newest) return std::nullopt;
  command.at_step = *newest;
  return command;
}

}  // namespace aurasim::process
