#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/going_run.h"
#include "cli/kept_on_disk.h"
#include "cli/launch_setup.h"
#include "cli/leave.h"
#include "cli/long_work.h"
#include "cli/node_process.h"
#include "cli/other_role.h"
#include "cli/run_length.h"
#include "cli/saved_world.h"
#include "cli/scene_warnings.h"
#include "cli/spawn.h"
#include "cli/stop_signal.h"
#include "physics/region_world.h"

namespace aurasim::cli {
namespace {

struct NodeArguments {
  FileArguments files;
  KeyArguments keys;
  std::uint32_t region = 0;
  std::uint64_t run = 0;
  RunLength length;
  std::string report;
  LoadArguments load;
  SaveArguments save;
  int start_time_out_s = 30;
  bool takes_over = false;
  LauncherArguments launcher;
  bool or_spare = false;
};

/// Does not return: the rest of the command line is that of the spare, or of the node.
[[noreturn]] void become_node_or_spare(const config::Launch& launch, const NodeArguments& arguments) {
  leave_after([&] {
    const bool goes_on = a_run_goes_on(launch, arguments.keys.as, core::RegionId{arguments.region});
    if (stop_requested()) return ExitCode::kOk;
    if (goes_on) spdlog::info("the run goes on without this process, which becomes a spare");
    become(goes_on ? words_of_spare(own_words()) : words_of_plain_node(own_words()));
  });
}

int run_node(const NodeArguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  if (arguments.region >= launch.regions.size()) {
    throw config::BadConfig({fmt::format("--region: found {}, allowed: 0 to {} ({} has {} regions)", arguments.region,
                                         launch.regions.size() - 1, arguments.files.file, launch.regions.size())});
  }
  spdlog::set_pattern(fmt::format("%H:%M:%S.%e %^%l%$ region {}: %v", arguments.region));
  if (arguments.or_spare) {
    catch_stop_signals();
    become_node_or_spare(launch, arguments);
  }
  // Once in a run; `launch` starts this node as well.
  if (arguments.region == 0 && !arguments.takes_over) {
    LongWork work("looking for bodies that overlap", [](const std::string& text) { spdlog::info("{}", text); });
    for (const std::string& text : scene_warnings(launch, [&work](double share) { work.reached(share); })) {
      spdlog::warn("{}", text);
    }
  }
  catch_stop_signals();
  NodeOptions options;
  options.region = core::RegionId{arguments.region};
  options.run = arguments.run;
  options.as = arguments.keys.as;
  options.start_time_out = std::chrono::seconds(arguments.start_time_out_s);
  options.world = load_world(arguments.load, launch);
  options.saves = arguments.save.folder;
  options.save_every = static_cast<core::Step>(std::llround(arguments.save.every_s * launch.time.step_hz));
  options.save_keep = arguments.save.keep;
  options.kept = kept_folder(launch, arguments.save);
  if (!arguments.launcher.is_there) check_room_for_saves(launch, arguments.save);
  options.steps = arguments.length.last_step(launch, options.world ? options.world->step : 0);
  if (!arguments.report.empty()) options.report = arguments.report;
  options.takes_over = arguments.takes_over;
  options.has_launcher = arguments.launcher.is_there;
  options.heartbeat = arguments.launcher.heartbeat;
  NodeProcess process(launch, options);
  leave_after([&process] {
    const ExitCode code = process.run();
    if (!process.comes_back_as_spare()) return code;
    spdlog::info("comes back as a spare");
    become(words_of_spare(own_words()));
  });
}

}  // namespace

void LauncherArguments::add_to(CLI::App& command) {
  command.add_flag("--has-launcher", is_there, "whoever has started this process starts another one when a node dies")
      ->group("");
  command.add_option("--heartbeat", heartbeat, "number of the pipe that it reads signs of life from")->group("");
}

void add_node(CLI::App& program, Action& action) {
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
  arguments->load.add_to(*command);
  arguments->save.add_to(*command);
  command->footer("Example:\n  aurasim node demo --region 0 --report out");
  command->callback([arguments, &action] { action = [arguments] { return run_node(*arguments); }; });
}

}  // namespace aurasim::cli
