// A process without a region: when a node of the run dies or leaves, it receives a command to take that region over.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "cli/commands.h"
#include "command_line/leave.h"
#include "cut/saved_world.h"
#include "dds/control.h"
#include "dds/random_id.h"
#include "host/other_role.h"
#include "host/spawn.h"
#include "host/stop_signal.h"
#include "messages/status_period.h"
#include "setup/arguments.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"
#include "setup/run_length.h"
#include "setup/silence.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kRound = 50ms;

struct SpareArguments {
  command_line::FileArguments files;
  setup::KeyArguments keys;
  std::uint64_t run = 0;
  std::string report;
  setup::RunLength length;
  cut::LoadArguments load;
  cut::SaveArguments save;
  setup::LauncherArguments launcher;  // passed on to the node that the spare becomes
};

class Spare {
 public:
  Spare(const config::Launch& launch, const std::string& as, std::uint64_t run)
      : launch_(launch),
        participant_(setup::with_keys(setup::dds_settings(launch), launch,
                                      setup::member_for(launch, as, {security::Role::kSpare}))),
        control_(participant_, {.region = messages::kNoRegion,
                                .agreement = launch.agreement(),
                                .run = run_if_known(run),
                                .region_count = static_cast<std::uint32_t>(launch.regions.size())}) {
    status_.region = messages::kNoRegion;
    status_.state = messages::NodeState::kSpare;
    status_.agreement = launch.agreement();
    status_.map_version = launch.regions.version();
    status_.footprint = launch.regions.region(core::RegionId{0});
    status_.run = run;
    status_.pid = static_cast<std::uint32_t>(::getpid());
    status_.process = dds::draw_id();
    status_.text = "a spare: takes over a region whose node dies";
  }

  /// Waits for the command to take a region over. Nothing if the run has ended, or this process was asked to stop.
  std::optional<messages::RunCommand> wait() {
    bool has_seen_it = false;
    setup::SilenceWord silence(launch_, participant_);
    while (!host::stop_requested()) {
      const auto& statuses = control_.statuses();
      const auto lives = [](const auto& entry) { return entry.second.is_live(); };
      const auto live = std::ranges::find_if(statuses, lives);
      if (live != statuses.end()) status_.run = live->second.status.run;
      if (has_seen_it && std::ranges::all_of(statuses, [&](const auto& entry) {
            return entry.second.status.state == messages::NodeState::kFinished;
          })) {
        return std::nullopt;
      }
      has_seen_it = has_seen_it || live != statuses.end();
      silence.look(has_seen_it);
      for (const messages::RunCommand& command : control_.take_commands()) {
        if (command.kind == messages::RunCommandKind::kTake && command.process == status_.process) return command;
      }
      publish();
      control_.wait(kRound);
    }
    return std::nullopt;
  }

 private:
  static std::optional<std::uint64_t> run_if_known(std::uint64_t run) {
    return run == 0 ? std::nullopt : std::optional(run);
  }

  /// Publishes the status, at intervals. Without them it would publish at each wake-up, and its own status wakes it up,
  /// too.
  void publish() {
    const auto now = std::chrono::steady_clock::now();
    if (now < published_ + messages::status_period(launch_.regions.size())) return;
    published_ = now;
    control_.publish_status(status_);
  }

  const config::Launch& launch_;
  dds::Participant participant_;
  dds::ControlBus control_;
  messages::Status status_;
  std::chrono::steady_clock::time_point published_;
};

int run_spare(const SpareArguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  cut::load_world(arguments.load, launch);  // a bad file is refused now, not at the take-over
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ spare: %v");
  host::catch_stop_signals();
  Spare spare(launch, arguments.keys.as, arguments.run);
  const std::optional<messages::RunCommand> take = spare.wait();
  if (!take) command_line::leave(0);  // without deleting the participant, as nodes do
  spdlog::info("takes over region {}", core::value_of(take->region));
  host::become(host::words_of_successor(host::own_words(), take->region, take->run));
}

}  // namespace

void add_spare(CLI::App& program, command_line::Action& action) {
  CLI::App* command =
      program.add_subcommand("spare", "wait for a run, and take over a region whose node dies or leaves");
  const auto arguments = std::make_shared<SpareArguments>();
  arguments->files.add_to(*command);
  arguments->keys.add_to(*command);
  command->add_option("--run", arguments->run, "the number of the run that is meant; 0: whichever is there");
  command->add_option("--report", arguments->report, "folder for what it records as a node");
  arguments->launcher.add_to(*command);
  arguments->length.add_to(*command);
  setup::add_to(*command, arguments->load);
  setup::add_to(*command, arguments->save);
  command->footer("Example:\n  aurasim spare demo");
  command->callback([arguments, &action] { action = [arguments] { return run_spare(*arguments); }; });
}

}  // namespace aurasim::cli
