#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/commands.h"
#include "command_line/leave.h"
#include "host/stop_signal.h"
#include "overseer/mesh_process.h"
#include "overseer/overseer.h"
#include "overseer/run_command_sink.h"
#include "overseer/web_setup.h"
#include "setup/arguments.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"
#include "setup/silence.h"

namespace aurasim::cli {
namespace {

struct OverseerArguments {
  command_line::FileArguments files;
  setup::KeyArguments keys;
  overseer::WebArguments web;
  std::string recording;
};

/// For an overseer whose key permits no commands.
class RefusingSink final : public overseer::CommandSink {
 public:
  void submit(overseer::Request request) override {
    replies_.push_back({request.client, request.id, false,
                        "this viewer has the key of a viewer: it sees, and asks for nothing", nullptr});
  }
  std::vector<overseer::Reply> take_replies() override { return std::exchange(replies_, {}); }

 private:
  std::vector<overseer::Reply> replies_;
};

int oversee(const OverseerArguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  const overseer::WebSettings settings = overseer::web_settings(launch, arguments.web);
  overseer::ShapeStore shapes(overseer::read_mesh_apart);
  const std::unique_ptr<overseer::WebServer> web = overseer::open_web_server(settings, arguments.web, shapes);
  using security::Role;
  const auto member = setup::member_for(launch, arguments.keys.as, {Role::kOperator, Role::kViewer});
  const bool only_watches = member && member->role == Role::kViewer;
  dds::Participant participant(setup::with_keys(setup::dds_settings(launch), launch, member));
  dds::ControlBus control(participant, {.map_version = launch.regions.version(),
                                        .agreement = launch.agreement(),
                                        .region_count = static_cast<std::uint32_t>(launch.regions.size()),
                                        .only_watches = only_watches});
  std::unique_ptr<overseer::CommandSink> sink = std::make_unique<RefusingSink>();
  if (!only_watches) sink = std::make_unique<overseer::RunCommandSink>(launch, participant, control, shapes);
  overseer::Overseer overseer(launch, participant, control, *web, *sink);
  if (!arguments.recording.empty()) overseer.record(arguments.recording);
  host::catch_stop_signals();
  setup::SilenceWord silence(launch, participant);
  command_line::leave_after([&] {
    while (!host::stop_requested()) {
      overseer.turn();
      silence.look(!control.statuses().empty());
    }
    return command_line::ExitCode::kOk;
  });
}

}  // namespace

void add_overseer(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("overseer", "serve the viewer of a run; start and stop it as you like");
  const auto arguments = std::make_shared<OverseerArguments>();
  arguments->files.add_to(*command);
  arguments->keys.add_to(*command);
  arguments->web.add_to(*command);
  command->add_option("--record", arguments->recording, "write down what pages see; `aurasim replay` shows it again");
  command->footer("Example:\n  aurasim overseer demo --port 8081");
  command->callback([arguments, &action] { action = [arguments] { return oversee(*arguments); }; });
}

}  // namespace aurasim::cli
