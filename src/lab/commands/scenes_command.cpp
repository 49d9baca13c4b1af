#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "command_line/exit_code.h"
#include "lab/commands/commands.h"
#include "lab/commands/progress_bar.h"
#include "lab/commands/stop_flag.h"
#include "lab/scenes/scenes.h"
#include "setup/launch_setup.h"

namespace aurasim::lab::commands {
namespace {

struct ScenesArguments {
  lab::ScenesPlan plan;
  std::string seeds = "1-200";
  std::string sync = "deterministic";
  std::string network = "good";
  std::filesystem::path out;
  std::filesystem::path case_folder;  ///< empty: seeds
  std::uint64_t network_seed = 1;
  int threads = 2;
  bool no_shrink = false;
};

/// Reads a range of seeds, "A-B" or "A". Returns the error; empty if there is none.
std::string read_seeds(const std::string& text, std::uint64_t& first, std::uint64_t& last) {
  const std::string wrong = "found \"" + text + "\", allowed: A-B or A, whole numbers with A up to B";
  const std::size_t dash = text.find('-');
  const std::string low = text.substr(0, dash), high = dash == std::string::npos ? low : text.substr(dash + 1);
  if (!CLI::detail::lexical_cast(low, first) || !CLI::detail::lexical_cast(high, last) || first > last) return wrong;
  return {};
}

lab::ScenesPlan plan_of(const ScenesArguments& arguments) {
  lab::ScenesPlan plan = arguments.plan;
  read_seeds(arguments.seeds, plan.first, plan.last);
  plan.rules.sync = *core::sync_named(arguments.sync);
  plan.rules.bad_network = arguments.network != "good";
  plan.rules.partitions = arguments.network == "cut";
  plan.rules.setup_of = [](const config::Launch& launch, core::RegionId region) {
    return setup::node_setup(launch, region, 0);
  };
  if (arguments.no_shrink) plan.shrink_s = 0;
  return plan;
}

int run_case(const lab::ScenesPlan& plan, const ScenesArguments& arguments) {
  const std::atomic<bool> stop = false;
  const lab::WorldOutcome o = *lab::run_world(arguments.case_folder, plan.rules, arguments.network_seed, stop);
  if (!o.error.empty()) fmt::print("error: {}\n", o.error);
  fmt::print("{}, {} regions, {} bodies, largest cluster {}, {} hand-offs\n",
             o.first_difference ? fmt::format("state {} differs from one node", *o.first_difference)
             : o.is_equal()     ? fmt::format("equal: {} steps, the same bits in every one", plan.rules.steps + 1)
                                : "no result",
             o.regions, o.bodies, o.largest_cluster, o.hand_offs);
  fmt::print("{} late, {} missed, {} of them without a flag ({} on one node)\n", o.late, o.missed, o.unflagged,
             o.unflagged_on_one);
  fmt::print("{} violations: {} speed, {} latency, {} promise, {} span; {} bodies broken\n", o.violations, o.speed,
             o.latency, o.promise, o.span, o.broken);
  fmt::print("{} redos, {} states computed again\n", o.redos, o.computed_again);
  if (!o.first_fault.empty()) fmt::print("{}\n", o.first_fault);
  fmt::print("{:.2f} s of CPU on regions, {:.2f} s on one node\n", o.regions_s, o.one_s);
  return static_cast<int>(o.has_failed() ? command_line::ExitCode::kFailed : command_line::ExitCode::kOk);
}

int run_seeds(const lab::ScenesPlan& plan, const ScenesArguments& arguments) {
  const StopFlag stop;
  ProgressBar bar;
  const bool finished = lab::run_scenes(plan, arguments.out, arguments.threads, std::ref(bar), stop);
  const nlohmann::json sums = lab::summarise_scenes(plan, arguments.out);
  fmt::print("{} seeds: {} differ from one node; {} late, {} missed, {} of them without a flag\n",
             sums["seeds"].get<int>(), sums["differ"].get<int>(), sums["late"].get<int>(), sums["missed"].get<int>(),
             sums["unflagged"].get<int>());
  if (!sums["failed_seeds"].empty()) fmt::print("failed: {}\n", sums["failed_seeds"].dump());
  if (!finished)
    spdlog::warn("stopped after {} seeds. Run the same command again to continue", sums["seeds"].get<int>());
  return static_cast<int>(finished && sums["failed_seeds"].empty() ? command_line::ExitCode::kOk
                                                                   : command_line::ExitCode::kFailed);
}

int run_scenes_command(const ScenesArguments& arguments) {
  const lab::ScenesPlan plan = plan_of(arguments);
  return arguments.case_folder.empty() ? run_seeds(plan, arguments) : run_case(plan, arguments);
}

void add_rules(CLI::App& command, const std::shared_ptr<ScenesArguments>& a) {
  command.add_option("--steps", a->plan.rules.steps, "of each run")->check(CLI::Range(1, 1'000'000));
  command.add_option("--sync", a->sync, "how nodes wait for each other")
      ->check(CLI::IsMember({"free_running", "bounded", "deterministic"}));
  command
      .add_option(
          "--network", a->network,
          "good: a tenth of a step of delay; bad: loss, delay, jitter, duplicates, messages that overtake others; cut: "
          "that, and nothing passes between some of the nodes and the others, three times for up to two seconds")
      ->check(CLI::IsMember({"good", "bad", "cut"}));
  auto* save = command.add_option("--save-at", a->plan.rules.save_at,
                                  "save the world in this state, and go on from the file as well");
  command.add_option("--load-on", a->plan.rules.load_on, "numbers of nodes, with --save-at")
      ->delimiter(',')
      ->check(CLI::Range(1, 16))
      ->needs(save);
  command
      .add_option("--deaths", a->plan.rules.deaths,
                  "so many nodes die under way, and all go back to what is kept of an earlier state")
      ->check(CLI::Range(0, 100))
      ->excludes(save);
  command.add_option("--set", a->plan.rules.overrides, "key.path=value, as for launch, in every world");
}

}  // namespace

void add_scenes(CLI::App& experiment, command_line::Action& action) {
  CLI::App* command = experiment.add_subcommand(
      "scenes", "random worlds, each on its regions and on one node: every state must have the same bits");
  const auto a = std::make_shared<ScenesArguments>();
  command->add_option("--seeds", a->seeds, "A-B: one world each")->check([](const std::string& text) {
    std::uint64_t first = 0, last = 0;
    return read_seeds(text, first, last);
  });
  add_rules(*command, a);
  auto* out = command->add_option("--out", a->out, "folder for the results; one that holds part of them is completed");
  auto* one =
      command
          ->add_option("--case", a->case_folder, "instead of seeds the world in this folder, such as OUT/seed_7/shrunk")
          ->check(CLI::ExistingDirectory)
          ->excludes(out);
  command->add_option("--network-seed", a->network_seed, "of the network's faults, with --case")->needs(one);
  command->add_option("--threads", a->threads, "worlds at the same time")->check(CLI::Range(1, 64));
  command->add_option("--shrink-seconds", a->plan.shrink_s, "so long each failing world is made smaller")
      ->check(CLI::Range(0.0, 86400.0));
  command->add_flag("--keep", a->plan.keep, "the files of all worlds stay, to be run by other means");
  command->add_flag("--no-shrink", a->no_shrink, "failing worlds stay as they are");
  command->footer("Example:\n  aurasim-lab experiment scenes --seeds 1-200 --out out");
  command->callback([a, out, one, &action] {
    if (out->count() + one->count() == 0) throw CLI::RequiredError("--out or --case");
    action = [a] { return run_scenes_command(*a); };
  });
}

}  // namespace aurasim::lab::commands
