#include "launch/merged_report.h"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "host/terminal.h"
#include "launch/closing_line.h"

namespace aurasim::launch {
namespace {

/// The share of the computing time that redos took, as text; empty if there were none.
std::string cost_of_redos(const records::Accounts& accounts) {
  if (accounts.redos == 0) return {};
  return fmt::format("; {} redos took {:.1f} % of the computing time", accounts.redos, 100 * accounts.redo_share);
}

}  // namespace

std::string closing_line(const records::Accounts& accounts) {
  if (accounts.incomplete.empty()) {
    return fmt::format(
        "{} bodies alive, {} lost, {} duplicated; {} hand-offs, {} thrashed; real-time factor {:.3f}{}{}\n",
        accounts.bodies, accounts.lost, accounts.duplicated, accounts.hand_offs, accounts.thrashed,
        accounts.real_time_factor, cost_of_redos(accounts), words_of_broken_promises(accounts.violations));
  }
  std::vector<std::uint32_t> regions;
  for (const records::IncompleteRegion& region : accounts.incomplete) regions.push_back(core::value_of(region.region));
  return fmt::format(
      "{} bodies alive for sure, {} duplicated; not known of {} bodies: alive or lost, since the records of regions "
      "[{}] "
      "end before the run; at least {} hand-offs, {} thrashed; real-time factor {:.3f}{}{}\n",
      accounts.bodies, accounts.duplicated, accounts.unaccounted, fmt::join(regions, ", "), accounts.hand_offs,
      accounts.thrashed, accounts.real_time_factor, cost_of_redos(accounts),
      words_of_broken_promises(accounts.violations));
}

command_line::ExitCode merge_and_print(const std::filesystem::path& folder, const records::RunFacts& facts,
                                       command_line::ExitCode so_far) {
  const records::Accounts accounts = records::merge_report(folder, facts);
  host::print(fmt::format("report: {}\n", (folder / "summary.json").string()));
  host::print(closing_line(accounts));
  for (const records::DeadRegion& dead : accounts.dead) {
    host::print(fmt::format("region {} died and took {} bodies with it\n", core::value_of(dead.region), dead.bodies));
  }
  for (const records::IncompleteRegion& region : accounts.incomplete) {
    spdlog::error("the records of region {} end after step {}: {}", core::value_of(region.region), region.after_step,
                  region.why);
  }
  for (const std::string& file : accounts.not_merged) {
    spdlog::error("the disk has no room for {}: the rows stay in {}", (folder / file).string(),
                  (folder / "region_*").string());
  }
  const bool complete = accounts.incomplete.empty() && accounts.not_merged.empty();
  return accounts.lost + accounts.duplicated == 0 && complete ? so_far : command_line::ExitCode::kFailed;
}

}  // namespace aurasim::launch
