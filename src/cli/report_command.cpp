#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "config/launch.h"
#include "launch/merged_report.h"

namespace aurasim::cli {
namespace {

struct ReportArguments {
  command_line::FileArguments files;
  std::string folder;
};

/// A report is written only where nodes have recorded something.
void check_folder(const ReportArguments& arguments, const config::Launch& launch) {
  for (std::size_t r = 0; r < launch.regions.size(); ++r) {
    const std::filesystem::path folder = std::filesystem::path(arguments.folder) / fmt::format("region_{}", r);
    if (std::filesystem::is_directory(folder)) return;
  }
  throw config::BadConfig(
      {fmt::format("{}: has no folder of a node, region_0 to region_{}", arguments.folder, launch.regions.size() - 1)});
}

int merge(const ReportArguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  check_folder(arguments, launch);
  records::RunFacts facts;
  facts.regions = launch.regions.size();
  facts.step_s = launch.step_s();
  facts.died = records::regions_without_end(arguments.folder, facts.regions);
  return static_cast<int>(launch::merge_and_print(
      arguments.folder, facts, facts.died.empty() ? command_line::ExitCode::kOk : command_line::ExitCode::kFailed));
}

}  // namespace

void add_report(CLI::App& program, command_line::Action& action) {
  CLI::App* command =
      program.add_subcommand("report", "merge what the nodes of separate hosts have recorded, as launch does");
  const auto arguments = std::make_shared<ReportArguments>();
  arguments->files.add_to(*command);
  command->add_option("DIR", arguments->folder, "the region_N folders of all nodes")
      ->required()
      ->check(CLI::ExistingDirectory);
  command->footer("Example:\n  aurasim report demo out");
  command->callback([arguments, &action] { action = [arguments] { return merge(*arguments); }; });
}

}  // namespace aurasim::cli
