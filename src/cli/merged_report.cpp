#include "cli/merged_report.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/terminal.h"

namespace aurasim::cli {

ExitCode merge_and_print(const std::filesystem::path& folder, const node::RunFacts& facts, ExitCode so_far) {
  const node::Accounts accounts = node::merge_report(folder, facts);
  print(fmt::format("report: {}\n", (folder / "summary.json").string()));
  print(fmt::format(
      "{} bodies alive, {} lost, {} duplicated; {} hand-offs, {} thrashed, {} taken back; real-time factor {:.3f}\n",
      accounts.bodies, accounts.lost, accounts.duplicated, accounts.hand_offs, accounts.thrashed, accounts.reclaimed,
      accounts.real_time_factor));
  for (const node::DeadRegion& dead : accounts.dead) {
    print(fmt::format("region {} died and took {} bodies with it\n", core::value_of(dead.region), dead.bodies));
  }
  for (const node::IncompleteRegion& region : accounts.incomplete) {
    spdlog::error("the records of region {} end after step {}: {}", core::value_of(region.region), region.after_step,
                  region.why);
  }
  for (const std::string& file : accounts.not_merged) {
    spdlog::error("no room for {}; the rows are in {}", (folder / file).string(), (folder / "region_*").string());
  }
  const bool complete = accounts.incomplete.empty() && accounts.not_merged.empty();
  return accounts.lost + accounts.duplicated == 0 && complete ? so_far : ExitCode::kFailed;
}

}  // namespace aurasim::cli
