// `aurasim-lab run SUITE`.
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "command_line/exit_code.h"
#include "host/stop_signal.h"
#include "host/version.h"
#include "lab/commands/commands.h"
#include "lab/commands/progress_bar.h"
#include "lab/commands/rain_suites.h"
#include "lab/commands/target_list.h"
#include "lab/suites/results_file.h"
#include "lab/suites/suites.h"

namespace aurasim::lab::commands {
namespace {

struct RunArguments {
  std::string suite;
  std::string results = "docs/results";
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

int run_suite(const RunArguments& arguments) {
  host::catch_stop_signals();
  const lab::Suite suite = suite_named(arguments.suite);
  const auto begin = std::chrono::steady_clock::now();
  ProgressBar bar;
  const auto results = suite.run(arguments.full ? lab::Effort::kFull : lab::Effort::kQuick, [&](double share) {
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    bar.show({share, elapsed_s, share > 0 ? elapsed_s * (1 - share) / share : 0});
    return !host::stop_requested();
  });
  bar.end();
  if (host::stop_requested()) {
    spdlog::warn("stopped before the end; nothing was stored. Run the same command again");
    return fail();
  }
  const std::filesystem::path file = std::filesystem::path(arguments.results) / (arguments.suite + ".jsonl");
  const bool as_stored = arguments.full || compare(file, results.rows);
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
  command->add_option("--results", arguments->results, "folder with SUITE.jsonl, to which the rows are appended");
  command->footer(about +
                  "scripts/render_pages.py puts stored results into the pages. Example:\n"
                  "  aurasim-lab run accuracy --full");
  command->callback([arguments, &action] { action = [arguments] { return run_suite(*arguments); }; });
}

}  // namespace aurasim::lab::commands
