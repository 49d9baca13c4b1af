#include <memory>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/commands.h"
#include "command_line/leave.h"
#include "config/launch_checks.h"
#include "cut/kept_on_disk.h"
#include "cut/part_writer.h"
#include "host/host_room.h"
#include "host/stop_signal.h"
#include "launch/launcher.h"
#include "launch/throw_away_keys.h"
#include "overseer/web_setup.h"
#include "setup/key_choice.h"
#include "setup/run_length.h"

namespace aurasim::cli {
namespace {

struct LaunchArguments {
  setup::LaunchOptions options;
  setup::RunLength length;
  std::string report;
  bool secure = false;
};

/// Refuses a launch that this host cannot run, before anything is started, and warns of one that may be slow.
void look_at_host(const config::Launch& launch, const setup::LaunchOptions& options) {
  if (const auto problem = host::problem_with_regions(launch.regions.size(), launch.dds.domain)) {
    throw config::BadConfig({fmt::format("{}: {}", options.files.file, *problem)});
  }
  if (const auto warning = host::warning_of_turns(launch.regions.size(), std::thread::hardware_concurrency())) {
    spdlog::warn("{}", *warning);
  }
  if (options.headless && options.recording.empty()) return;
  overseer::check_tls_of(launch);
  const auto problem =
      host::problem_with_listening(launch.overseer.bind, static_cast<std::uint16_t>(launch.overseer.port));
  if (problem) throw std::runtime_error(*problem);
  if (!options.recording.empty()) overseer::check_recording(options.recording);
}

/// Keys for this run alone, if the user asks for them. The started processes get them as any other keys.
std::unique_ptr<launch::ThrowAwayKeys> keys_for(LaunchArguments& arguments) {
  if (!arguments.secure) return nullptr;
  const command_line::FileArguments& files = arguments.options.files;
  const config::Launch launch = config::read_launch(files.file, files.overrides);
  if (!launch.dds.security.empty()) {
    throw config::BadConfig({"--secure: found dds.security as well, allowed: one of them"});
  }
  auto keys = std::make_unique<launch::ThrowAwayKeys>(launch.regions.size());
  const std::string folder = "dds.security=" + keys->folder().string();
  spdlog::info("a run with keys; others on this host join it with --set {}", folder);
  arguments.options.files.overrides.push_back(folder);
  return keys;
}

/// Checks the keys before the start, because otherwise each process would report the same error in the middle of it.
void look_at_keys(const config::Launch& launch) {
  for (std::uint32_t r = 0; r < launch.regions.size(); ++r) {
    setup::with_keys({}, launch, setup::member_for_node(launch, "", core::RegionId{r}));
  }
  if (launch.dds.discovery != config::Discovery::kNeighbours) return;
  if (const std::string why = setup::why_no_hub(launch); !why.empty()) {
    throw config::BadConfig({"dds.discovery: found neighbours, whose hub needs a key; " + why});
  }
}

/// Above this number of nodes a start with keys takes less time with a hub (docs/decisions/0055). Each pair of
/// processes that meet proves who they are, so it is less than config::kMostNodesWithoutHub.
constexpr std::size_t kMostNodesWithoutHubWithKeys = 9;

/// Gives a run of many nodes on this host a hub, unless the launch file says how they find each other.
config::Launch with_hub(config::Launch launch, command_line::FileArguments& files) {
  const std::size_t most_without =
      launch.dds.security.empty() ? config::kMostNodesWithoutHub : kMostNodesWithoutHubWithKeys;
  if (launch.dds.discovery != config::Discovery::kAuto || launch.regions.size() <= most_without ||
      !config::is_on_loopback(launch.dds)) {
    return launch;
  }
  if (const std::string why = setup::why_no_hub(launch); !why.empty()) {
    spdlog::info("{} nodes start without a hub, which would be faster: {}", launch.regions.size(), why);
    return launch;
  }
  files.overrides.emplace_back("dds.discovery=neighbours");
  return config::read_launch(files.file, files.overrides);
}

/// Prepares the folders for saved worlds, and the world that the run goes on from.
void prepare_saves(const config::Launch& launch, setup::LaunchOptions& options) {
  if (options.resume) {
    options.save.folder_is_given = true;
    options.load.file = cut::world_to_resume(launch, options.save);
  }
  cut::check_room_for_saves(launch, options.save);
}

int run_launch(LaunchArguments arguments) {
  for (const std::filesystem::path& folder : launch::remove_keys_of_the_gone()) {
    spdlog::info("removed the keys of a launch that was killed: {}", folder.string());
  }
  std::unique_ptr<launch::ThrowAwayKeys> throw_away = keys_for(arguments);
  command_line::FileArguments& files = arguments.options.files;
  const config::Launch launch = with_hub(config::read_launch(files.file, files.overrides), files);
  look_at_keys(launch);
  look_at_host(launch, arguments.options);
  prepare_saves(launch, arguments.options);
  const auto world =
      cut::load_world(arguments.options.load, launch);  // a bad file is refused before anything is started
  arguments.options.steps = arguments.length.last_step(launch, world ? world->step : 0);
  if (!arguments.report.empty()) arguments.options.report = arguments.report;
  launch::Launcher launcher(launch, arguments.options);
  command_line::leave_after([&] {
    const auto until_then = std::move(throw_away);  // leave() destroys no objects outside of this scope
    const setup::LaunchOptions& options = arguments.options;
    const bool is_kept = cut::kept_folder(launch, options.save).has_value();
    if (is_kept) {
      spdlog::info("its newest states are kept on disk: if all its processes end at once, `{}` goes on from there",
                   cut::resume_command(launch, options.save));
    }
    const command_line::ExitCode code = launcher.run();
    if (code == command_line::ExitCode::kNotSaved) spdlog::error("{}", cut::kNothingSaved);
    cut::conclude_kept(launch, options.save, launcher.number(),
                       code != command_line::ExitCode::kOk || host::stop_requested());
    return code;
  });
}

}  // namespace

void add_launch(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("launch", "run every region of a launch file on this host");
  const auto arguments = std::make_shared<LaunchArguments>();
  arguments->options.files.add_to(*command);
  arguments->options.keys.add_to(*command);
  command->add_flag("--secure", arguments->secure,
                    "with keys made for this run, on this host: nobody else can join, and what is said is encrypted");
  arguments->length.add_to(*command);
  command->add_flag("--headless", arguments->options.headless, "no table, no viewer");
  command->add_option("--record", arguments->options.recording, "file for what the viewer sees; starts it in any case");
  command->add_option("--report", arguments->report, "folder for what the nodes record");
  command
      ->add_option("--start-time-out", arguments->options.start_time_out_s,
                   "seconds to wait for all regions after the last news of any")
      ->check(CLI::Range(1, 3600));
  command
      ->add_option("--spares", arguments->options.spares,
                   "processes that wait to take over the region of a node that dies; without, one is started then")
      ->check(CLI::Range(0, 64));
  CLI::Option* const load = setup::add_to(*command, arguments->options.load);
  command
      ->add_flag("--resume", arguments->options.resume,
                 "go on from the newest state that is in --saves, or that a run has kept on disk (survival.disk)")
      ->excludes(load);
  setup::add_to(*command, arguments->options.save);
  command->footer("Example:\n  aurasim launch demo --duration 30 --report out");
  command->callback([arguments, &action] { action = [arguments] { return run_launch(*arguments); }; });
}

}  // namespace aurasim::cli
