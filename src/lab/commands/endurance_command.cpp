// `aurasim-lab experiment endurance`.
#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "command_line/exit_code.h"
#include "lab/commands/commands.h"
#include "lab/commands/stop_flag.h"
#include "lab/scenes/endurance.h"
#include "setup/launch_setup.h"

namespace aurasim::lab::commands {
namespace {

void print_line(const lab::Endured& so_far, std::chrono::steady_clock::time_point begin) {
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const nlohmann::ordered_json row = {{"hours", so_far.hours},
                                      {"state", so_far.state},
                                      {"wall_s", wall_s},
                                      {"resident_kB", so_far.resident_kB},
                                      {"bodies", so_far.bodies},
                                      {"deaths", so_far.deaths},
                                      {"loads", so_far.loads},
                                      {"orders", so_far.orders},
                                      {"computed", so_far.computed},
                                      {"compared", so_far.compared},
                                      {"failure", so_far.failure}};
  fmt::print("{}\n", row.dump());
  std::fflush(stdout);
}

int run_endurance(const command_line::FileArguments& files, lab::EndurancePlan plan) {
  command_line::FileArguments wanted = files;
  wanted.overrides.emplace_back("time.sync=deterministic");
  const config::Launch launch = config::read_launch(wanted.file, wanted.overrides);
  plan.setup_of = [](const config::Launch& of, core::RegionId region) { return setup::node_setup(of, region, 0); };
  const StopFlag stop;
  const auto begin = std::chrono::steady_clock::now();
  const lab::Endured end = lab::endure(
      launch, plan, [begin](const lab::Endured& so_far) { print_line(so_far, begin); }, stop);
  return static_cast<int>(end.failure.empty() ? command_line::ExitCode::kOk : command_line::ExitCode::kFailed);
}

}  // namespace

void add_endurance(CLI::App& experiment, command_line::Action& action) {
  CLI::App* command = experiment.add_subcommand(
      "endurance",
      "hours of a run in virtual time in which nodes die and worlds are saved and loaded, state by state "
      "beside one node; a line of JSON every so often");
  const auto files = std::make_shared<command_line::FileArguments>();
  const auto plan = std::make_shared<lab::EndurancePlan>();
  files->add_to(*command);
  command->add_option("--hours", plan->hours, "simulated")->check(CLI::Range(1e-3, 1e6));
  command->add_option("--every", plan->told_every_h, "a line each so many simulated hours")
      ->check(CLI::Range(1e-3, 1e6));
  command->add_option("--seed", plan->seed, "of all that happens");
  command->footer("Example:\n  aurasim-lab experiment endurance tower --hours 24");
  command->callback([files, plan, &action] { action = [files, plan] { return run_endurance(*files, *plan); }; });
}

}  // namespace aurasim::lab::commands
