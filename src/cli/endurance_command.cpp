// `aurasim experiment endurance`.
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/launch_setup.h"
#include "cli/stop_signal.h"
#include "experiment/scenes/endurance.h"

namespace aurasim::cli {
namespace {

void print_line(const experiment::Endured& so_far, std::chrono::steady_clock::time_point begin) {
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

int run_endurance(const FileArguments& files, experiment::EndurancePlan plan) {
  FileArguments wanted = files;
  wanted.overrides.emplace_back("time.sync=deterministic");
  const config::Launch launch = config::read_launch(wanted.file, wanted.overrides);
  plan.setup_of = [](const config::Launch& of, core::RegionId region) { return node_setup(of, region, 0); };
  catch_stop_signals();
  std::atomic<bool> stop = false;
  const std::jthread watch([&stop](const std::stop_token& done) {
    for (; !done.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
      if (stop_requested()) stop = true;
    }
  });
  const auto begin = std::chrono::steady_clock::now();
  const experiment::Endured end = experiment::endure(
      launch, plan, [begin](const experiment::Endured& so_far) { print_line(so_far, begin); }, stop);
  return static_cast<int>(end.failure.empty() ? ExitCode::kOk : ExitCode::kFailed);
}

}  // namespace

void add_endurance(CLI::App& experiment, Action& action) {
  CLI::App* command = experiment.add_subcommand(
      "endurance",
      "hours of a run in virtual time in which nodes die and worlds are saved and loaded, state by state "
      "beside one node; a line of JSON every so often");
  const auto files = std::make_shared<FileArguments>();
  const auto plan = std::make_shared<experiment::EndurancePlan>();
  files->add_to(*command);
  command->add_option("--hours", plan->hours, "simulated")->check(CLI::Range(1e-3, 1e6));
  command->add_option("--every", plan->told_every_h, "a line each so many simulated hours")
      ->check(CLI::Range(1e-3, 1e6));
  command->add_option("--seed", plan->seed, "of all that happens");
  command->footer("Example:\n  aurasim experiment endurance tower --hours 24");
  command->callback([files, plan, &action] { action = [files, plan] { return run_endurance(*files, *plan); }; });
}

}  // namespace aurasim::cli
