// `aurasim-lab run SUITE`.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "command_line/exit_code.h"
#include "host/stop_signal.h"
#include "host/version.h"
#include "lab/commands/commands.h"
#include "lab/commands/progress_bar.h"
#include "lab/commands/rain_suites.h"
#include "lab/suites/results_file.h"
#include "lab/suites/suites.h"

namespace aurasim::lab::commands {
namespace {

struct RunArguments {
  std::string suite;
  std::string results = "docs/results";
  std::vector<std::string> only;
  bool full = false;
};

std::vector<lab::Suite> all_suites() {
  std::vector<lab::Suite> all(lab::suites().begin(), lab::suites().end());
  for (const lab::Suite& suite : rain_suites()) all.push_back(suite);
  return all;
}

lab::Suite suite_named(const std::string& name) {
  for (const lab::Suite& suite : all_suites()) {
    if (suite.name == name) return suite;
  }
  throw std::invalid_argument("no suite of this name: " + name);
}

void print(const std::vector<lab::Target>& targets) {
  for (const lab::Target& t : targets) {
    fmt::print("{:<6} {:>10.4g}  {} {:.4g}  {}\n", t.met() ? "met" : "MISSED", t.found,
               t.at_least ? "at least" : "at most ", t.allowed, t.name);
  }
}

bool all_met(const std::vector<lab::Target>& targets) {
  return std::ranges::all_of(targets, [](const auto& t) { return t.met(); });
}

int fail() { return static_cast<int>(command_line::ExitCode::kFailed); }

/// False if a row is further from the stored full run than its tolerance.
bool compare(const std::filesystem::path& file, const std::vector<lab::ResultRow>& rows) {
  const auto found = lab::differences(file, rows);
  for (const lab::Difference& d : found) {
    const std::string unit = d.now.unit == "1" ? "" : " " + d.now.unit;
    fmt::print("DIFFERS {}, {}: {:.4g}{} now, {:.4g}{} stored (commit {}), more than {:g}% apart\n", d.now.what,
               d.now.metric, d.now.value, unit, d.stored, unit, d.stored_commit, 100 * lab::tolerance_of(d.now));
  }
  return found.empty();
}

/// Throws std::invalid_argument for a part that the suite does not have.
void check_parts(const lab::Suite& suite, const std::vector<std::string>& only) {
  const std::vector<std::string> parts = suite.parts();
  for (const std::string& part : only) {
    if (std::ranges::find(parts, part) != parts.end()) continue;
    throw std::invalid_argument(
        fmt::format("--only: found {}, allowed for the suite {}: {}", part, suite.name, fmt::join(parts, ", ")));
  }
}

int run_suite(const RunArguments& arguments) {
  const lab::Suite suite = suite_named(arguments.suite);
  check_parts(suite, arguments.only);
  lab::SuiteResults results;
  {
    ProgressBar bar;
    results = suite.run({arguments.full ? lab::Effort::kFull : lab::Effort::kQuick, arguments.only}, std::ref(bar));
  }
  if (host::stop_requested()) {
    spdlog::warn("stopped before the end; nothing was stored. Run the same command again");
    return fail();
  }
  // Some requirements are sums over all parts.
  if (!arguments.only.empty())
    std::erase_if(results.rows, [](const auto& row) { return row.what.starts_with("requirement/"); });
  const std::filesystem::path file = std::filesystem::path(arguments.results) / (arguments.suite + ".jsonl");
  const bool is_whole = arguments.full && arguments.only.empty();
  const bool as_stored = is_whole || compare(file, results.rows);
  lab::append_results(file, results.rows, lab::provenance_here(host::commit(), !arguments.full));
  fmt::print("{} rows appended to {}\n", results.rows.size(), file.string());
  print(results.targets);
  return as_stored && all_met(results.targets) ? static_cast<int>(command_line::ExitCode::kOk) : fail();
}

}  // namespace

void add_run(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("run", "measure what a page of docs/ shows, and store it");
  const auto arguments = std::make_shared<RunArguments>();
  std::vector<std::string> names;
  std::string about;
  for (const lab::Suite& suite : all_suites()) {
    names.emplace_back(suite.name);
    about += fmt::format("  {:<21} {}\n", suite.name, suite.about);
  }
  command->add_option("SUITE", arguments->suite, "what to measure")->required()->check(CLI::IsMember(names));
  command->add_flag("--full,!--quick", arguments->full,
                    "everything that the page shows; a quick run measures some of it, and says where it differs from "
                    "the stored full run");
  command
      ->add_option("--only", arguments->only,
                   "these parts of the suite alone; a part that is not there is answered with all that are")
      ->delimiter(',');
  command->add_option("--results", arguments->results, "folder with SUITE.jsonl, to which the rows are appended");
  command->footer(about +
                  "scripts/render_pages.py puts stored results into the pages. Example:\n"
                  "  aurasim-lab run accuracy --full\n"
                  "  aurasim-lab run accuracy --only card_house,wedge --results out");
  command->callback([arguments, &action] { action = [arguments] { return run_suite(*arguments); }; });
}

}  // namespace aurasim::lab::commands
