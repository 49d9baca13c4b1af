#include <memory>

#include "cli/commands.h"
#include "cli/merged_report.h"
#include "config/launch.h"

namespace aurasim::cli {
namespace {

struct Arguments {
  FileArguments files;
  std::string folder;
};

int merge(const Arguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  node::RunFacts facts;
  facts.regions = launch.regions.size();
  facts.step_s = launch.step_s();
  facts.died = node::regions_without_end(arguments.folder, facts.regions);
  return static_cast<int>(
      merge_and_print(arguments.folder, facts, facts.died.empty() ? ExitCode::kOk : ExitCode::kFailed));
}

}  // namespace

void add_report(CLI::App& program, Action& action) {
  CLI::App* command =
      program.add_subcommand("report", "merge what the nodes of separate hosts have recorded, as launch does");
  const auto arguments = std::make_shared<Arguments>();
  arguments->files.add_to(*command);
  command->add_option("DIR", arguments->folder, "the region_N folders of all nodes")
      ->required()
      ->check(CLI::ExistingDirectory);
  command->callback([arguments, &action] { action = [arguments] { return merge(*arguments); }; });
}

}  // namespace aurasim::cli
