#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "cli/commands.h"
#include "command_line/leave.h"
#include "cut/kept_on_disk.h"
#include "cut/saved_world.h"
#include "host/long_work.h"
#include "host/other_role.h"
#include "host/spawn.h"
#include "host/stop_signal.h"
#include "physics/region_world.h"
#include "process/node_process.h"
#include "setup/arguments.h"
#include "setup/launch_setup.h"
#include "setup/run_length.h"
#include "setup/scene_warnings.h"
#include "steering/going_run.h"

namespace aurasim::cli {
namespace {

struct NodeArguments {
  command_line::FileArguments files;
  setup::KeyArguments keys;
  std::uint32_t region = 0;
  std::uint64_t run = 0;
  setup::RunLength length;
  std::string report;
  cut::LoadArguments load;
  cut::SaveArguments save;
  int start_time_out_s = 30;
  bool takes_over = false;
  setup::LauncherArguments launcher;
  bool or_spare = false;
};

/// Does not return: the rest of the command line is that of the spare, or of the node.
[[noreturn]] void become_node_or_spare(const config::Launch& launch, const NodeArguments& arguments) {
  command_line::leave_after([&] {
    const bool goes_on = steering::a_run_goes_on(launch, arguments.keys.as, core::RegionId{arguments.region});
    if (host::stop_requested()) return command_line::ExitCode::kOk;
    if (goes_on) spdlog::info("the run goes on without this process, which becomes a spare");
    host::become(goes_on ? host::words_of_spare(host::own_words()) : host::words_of_plain_node(host::own_words()));
  });
}

int run_node(const NodeArguments& arguments) {
  config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  if (arguments.region >= launch.regions.size()) {
    throw config::BadConfig({fmt::format("--region: found {}, allowed: 0 to {} ({} has {} regions)", arguments.region,
                                         launch.regions.size() - 1, arguments.files.file, launch.regions.size())});
  }
  spdlog::set_pattern(fmt::format("%H:%M:%S.%e %^%l%$ region {}: %v", arguments.region));
  if (arguments.or_spare) {
    host::catch_stop_signals();
    become_node_or_spare(launch, arguments);
  }
  // Once in a run; `launch` starts this node as well.
  if (arguments.region == 0 && !arguments.takes_over) {
    host::LongWork work("looking for bodies that overlap", [](const std::string& text) { spdlog::info("{}", text); });
    for (const std::string& text : setup::scene_warnings(launch, [&work](double share) { work.reached(share); })) {
      spdlog::warn("{}", text);
    }
  }
  host::catch_stop_signals();
  process::NodeOptions options;
  options.region = core::RegionId{arguments.region};
  options.run = arguments.run;
  options.as = arguments.keys.as;
  options.start_time_out = std::chrono::seconds(arguments.start_time_out_s);
  options.world = cut::load_world(arguments.load, launch);
  options.saves = arguments.save.folder;
  options.save_every = static_cast<core::Step>(std::llround(arguments.save.every_s * launch.time.step_hz));
  options.save_keep = arguments.save.keep;
  options.kept = cut::kept_folder(launch, arguments.save);
  if (!arguments.launcher.is_there) cut::check_room_for_saves(launch, arguments.save);
  options.steps = arguments.length.last_step(launch, options.world ? options.world->step : 0);
  if (!arguments.report.empty()) options.report = arguments.report;
  options.takes_over = arguments.takes_over;
  options.has_launcher = arguments.launcher.is_there;
  options.heartbeat = arguments.launcher.heartbeat;
  process::NodeProcess process(std::move(launch), options);
  command_line::leave_after([&process] {
    const command_line::ExitCode code = process.run();
    if (!process.comes_back_as_spare()) return code;
    spdlog::info("comes back as a spare");
    host::become(host::words_of_spare(host::own_words()));
  });
}

}  // namespace

void add_node(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("node", "run one region");
  const auto arguments = std::make_shared<NodeArguments>();
  arguments->files.add_to(*command);
  arguments->keys.add_to(*command);
  command->add_option("--region", arguments->region, "which region of the map")->required();
  command->add_option("--run", arguments->run,
                      "a number for this run, the same for all its nodes: they ignore every other run's");
  arguments->length.add_to(*command);
  command->add_option("--report", arguments->report, "folder for what the node records");
  command
      ->add_option("--start-time-out", arguments->start_time_out_s,
                   "seconds to wait for the other regions after the last news of any")
      ->check(CLI::Range(1, 3600));
  command->add_flag("--take-over", arguments->takes_over,
                    "the run is there, and its node of this region has died: go on with it");
  command->add_flag("--or-spare", arguments->or_spare,
                    "if the run is there and goes on without this node, wait as a spare: for whatever starts a node "
                    "again that has ended");
  arguments->launcher.add_to(*command);
  setup::add_to(*command, arguments->load);
  setup::add_to(*command, arguments->save);
  command->footer("Example:\n  aurasim node demo --region 0 --report out");
  command->callback([arguments, &action] { action = [arguments] { return run_node(*arguments); }; });
}

}  // namespace aurasim::cli
