#include "cli/merged_report.h"

#include <fmt/format.h>

namespace aurasim::cli {

ExitCode merge_and_print(const std::filesystem::path& folder, const node::RunFacts& facts, ExitCode so_far) {
  const node::Accounts accounts = node::merge_report(folder, facts);
  fmt::print("report: {}\n", (folder / "summary.json").string());
  fmt::print(
      "{} bodies alive, {} lost, {} duplicated; {} hand-offs, {} thrashed, {} taken back; real-time factor {:.3f}\n",
      accounts.bodies, accounts.lost, accounts.duplicated, accounts.hand_offs, accounts.thrashed, accounts.reclaimed,
      accounts.real_time_factor);
  for (const node::DeadRegion& dead : accounts.dead) {
    fmt::print("region {} died and took {} bodies with it\n", core::value_of(dead.region), dead.bodies);
  }
  return accounts.lost + accounts.duplicated == 0 ? so_far : ExitCode::kFailed;
}

}  // namespace aurasim::cli
