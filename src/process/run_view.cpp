#include "process/run_view.h"

#include <algorithm>

namespace aurasim::process {

RunView view_of_run(const SeenNodes& nodes, const messages::Status& own, std::optional<core::Step> holds_at) {
  const auto is_ours = [agreement = own.agreement](const messages::SeenStatus& seen) {
    return seen.status.agreement == agreement;
  };
  RunView run;
  run.leads = true;
  for (const auto& [region, seen] : nodes) {
    if (!is_ours(seen)) continue;
    run.facts.complete = run.facts.complete && seen.is_live();
    if (!seen.is_live()) continue;
    run.facts.bodies += seen.status.bodies;
    run.leads = run.leads && region >= own.region;
  }
  run.lacking = [&nodes, is_ours](std::uint64_t mesh) {
    std::vector<core::RegionId> lacking;
    for (const auto& [region, seen] : nodes) {
      const bool has_it = std::ranges::find(seen.status.meshes, mesh) != seen.status.meshes.end();
      if (is_ours(seen) && seen.is_live() && !has_it) lacking.push_back(region);
    }
    return lacking;
  };
  run.holds_at = holds_at;
  return run;
}

}  // namespace aurasim::process
