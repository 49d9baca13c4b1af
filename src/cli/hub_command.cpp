// The hub of a run with dds.discovery: neighbours.
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/commands.h"
#include "command_line/leave.h"
#include "config/launch.h"
#include "dds/hub.h"
#include "host/stop_signal.h"
#include "setup/arguments.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kTurn = 50ms;  ///< introductions are repeated in these turns

struct HubArguments {
  command_line::FileArguments files;
  setup::KeyArguments keys;
};

int run_hub(const HubArguments& arguments) {
  const command_line::FileArguments& files = arguments.files;
  const config::Launch launch = config::read_launch(files.file, files.overrides);
  if (launch.dds.discovery != config::Discovery::kNeighbours) {
    throw config::BadConfig({fmt::format("{}: dds.discovery needs a hub only if it is neighbours", files.file)});
  }
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ hub: %v");
  host::catch_stop_signals();
  const auto member = setup::member_for(launch, arguments.keys.as, {security::Role::kHub});
  dds::Hub hub(setup::with_keys(setup::dds_settings(launch), launch, member));
  while (!host::stop_requested()) hub.turn(kTurn);
  const dds::Hub::Counts counts = hub.counts();
  spdlog::debug("{} messages passed on, {} not, {} refused; {} pairs of processes introduced", counts.passed,
                counts.failed, counts.refused, counts.pairs);
  command_line::leave(0);  // in silence, as nodes do
}

}  // namespace

void add_hub(CLI::App& program, command_line::Action& action) {
  CLI::App* command =
      program.add_subcommand("hub", "let the processes of a run find each other, with dds.discovery: neighbours");
  const auto arguments = std::make_shared<HubArguments>();
  arguments->files.add_to(*command);
  arguments->keys.add_to(*command);
  command->footer("Example:\n  aurasim hub demo --set dds.discovery=neighbours");
  command->callback([arguments, &action] { action = [arguments] { return run_hub(*arguments); }; });
}

}  // namespace aurasim::cli
