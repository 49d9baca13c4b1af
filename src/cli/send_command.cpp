#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/commands.h"
#include "cli/launch_setup.h"
#include "cli/leave.h"
#include "cli/node_process.h"
#include "cli/run_steering.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Kind = dds::RunCommandKind;

const std::map<std::string, Kind> kKinds = {{"pause", Kind::kPause},
                                            {"resume", Kind::kResume},
                                            {"step", Kind::kStep},
                                            {"reset", Kind::kReset},
                                            {"stop", Kind::kStop}};

struct Arguments {
  std::string what;
  FileArguments files;
  std::int64_t count = 1;
};

[[noreturn]] void fail(const std::string& why) {
  spdlog::error("{}", why);
  leave(static_cast<int>(ExitCode::kFailed));
}

int send(const Arguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  dds::Participant participant(dds_settings(launch));
  dds::ControlBus control(participant, {launch.regions.version(), {}});
  RunSteering steering(launch, control);
  if (!steering.find_run(5s)) {
    fail(fmt::format("no run of {} in DDS domain {}", arguments.files.file, launch.dds.domain));
  }
  const dds::RunCommand command = steering.send(kKinds.at(arguments.what), arguments.count);
  if (!steering.wait_for_effect(command, 10s)) {
    fail(fmt::format("{} was sent, but not every node shows its effect", arguments.what));
  }
  fmt::print("{}: done at step {}\n", arguments.what, command.at_step);
  leave(0);
}

}  // namespace

void add_send(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("send", "steer a run: pause, resume, step, reset, stop");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("COMMAND", arguments->what, "what to do")
      ->required()
      ->check(CLI::IsMember({"pause", "resume", "step", "reset", "stop"}));
  arguments->files.add_to(*command);
  command->add_option("--count", arguments->count, "step: how many steps")->check(CLI::Range(1, 1'000'000));
  command->callback([arguments, &action] { action = [arguments] { return send(*arguments); }; });
}

}  // namespace aurasim::cli
