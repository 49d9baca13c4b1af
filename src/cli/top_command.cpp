#include <memory>

#include "cli/commands.h"
#include "command_line/leave.h"
#include "dds/control.h"
#include "host/stop_signal.h"
#include "launch/live_table.h"
#include "setup/arguments.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"
#include "setup/silence.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

int watch(const command_line::FileArguments& files, const setup::KeyArguments& keys, double seconds) {
  const config::Launch launch = config::read_launch(files.file, files.overrides);
  using security::Role;
  const auto member = setup::member_for(launch, keys.as,
                                        {Role::kViewer, Role::kOperator, Role::kRecorder, Role::kSpare, Role::kRegion});
  dds::Participant participant(setup::with_keys(setup::dds_settings(launch), launch, member));
  dds::ControlBus control(participant, {.agreement = launch.agreement(),
                                        .region_count = static_cast<std::uint32_t>(launch.regions.size()),
                                        .only_watches = true});
  launch::TerminalView view;
  host::catch_stop_signals();
  const auto begin = Clock::now();
  const auto end = begin + std::chrono::duration<double>(seconds);
  const auto nobody = [&] { return control.statuses().empty() && !host::stop_requested(); };
  while (!host::stop_requested() && (seconds <= 0 || Clock::now() < end)) {
    const auto next = Clock::now() + (view.is_terminal() ? 250ms : 1000ms);
    while (!host::stop_requested() && Clock::now() < next) control.wait(50ms);
    const launch::TerminalSize size = view.size();
    if (!view.show(launch::live_table(control.statuses(), size, std::chrono::steady_clock::now()) +
                   launch::listening_lines(control.statuses(), size)))
      break;
    if (nobody() && Clock::now() - begin > setup::kPatienceWithSilence) break;
  }
  if (nobody()) setup::fail_for_want_of_a_run(files, launch, participant);
  command_line::leave(0);
}

}  // namespace

void add_top(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("top", "watch the nodes of a run");
  const auto files = std::make_shared<command_line::FileArguments>();
  const auto keys = std::make_shared<setup::KeyArguments>();
  const auto seconds = std::make_shared<double>(0);
  files->add_to(*command);
  keys->add_to(*command);
  command->add_option("--duration", *seconds, "stop after so many seconds; 0: on Ctrl-C");
  command->footer("Example:\n  aurasim top demo");
  command->callback(
      [files, keys, seconds, &action] { action = [files, keys, seconds] { return watch(*files, *keys, *seconds); }; });
}

}  // namespace aurasim::cli
