#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "command_line/exit_code.h"
#include "config/shipped_files.h"
#include "host/stop_signal.h"
#include "lab/aura_radius.h"
#include "lab/collision.h"
#include "lab/commands/commands.h"
#include "lab/commands/progress_bar.h"
#include "lab/commands/target_list.h"
#include "lab/loss.h"
#include "lab/real_trials.h"
#include "lab/summary.h"
#include "physics/solver_names.h"

namespace aurasim::lab::commands {

std::vector<std::string> solver_names() {
  std::vector<std::string> names;
  for (const auto& [solver, name] : physics::kSolverNames) names.emplace_back(name);
  return names;
}

namespace {

struct TrialArguments {
  std::vector<std::string> pairs, auras, syncs;
  lab::CollisionPlan plan;
  std::string out;
  int threads = 2;
  std::uint32_t domain = 60;
  bool in_virtual_time = false;
};

template <class Value, class Named>
void choose(const std::vector<std::string>& names, Named&& named, std::vector<Value>& out) {
  for (const std::string& name : names) {
    if (const auto value = named(name)) out.push_back(*value);
  }
}

/// The flag follows the signal, which the threads of the laboratory cannot ask for themselves.
bool run_to_the_end(const lab::Campaign& campaign, const TrialArguments& arguments) {
  host::catch_stop_signals();
  std::atomic<bool> stop = false;
  ProgressBar bar;
  lab::RealLaboratory over_dds(arguments.domain, config::shipped_profiles());
  const lab::JobRunner in_real_time = [&](const auto& all, const auto& job) { return over_dds.run_job(all, job); };
  const lab::JobRunner run = arguments.in_virtual_time ? lab::run_job : in_real_time;
  const bool finished = lab::run_campaign(
      campaign, arguments.out, run, arguments.in_virtual_time ? arguments.threads : 1,
      [&](const lab::Progress& progress) {
        bar.show(progress);
        if (host::stop_requested()) stop = true;
      },
      stop);
  bar.end();
  return finished;
}

int run_trials(TrialArguments arguments, bool loss) {
  choose(arguments.pairs, lab::pair_named, arguments.plan.pairs);
  choose(arguments.auras, lab::aura_named, arguments.plan.auras);
  choose(arguments.syncs, core::sync_named, arguments.plan.syncs);
  lab::Campaign campaign = loss ? lab::loss_campaign(arguments.plan) : lab::collision_campaign(arguments.plan);
  campaign.over_dds = !arguments.in_virtual_time;
  if (!run_to_the_end(campaign, arguments)) {
    spdlog::warn("stopped; the same command goes on from here");
    return static_cast<int>(command_line::ExitCode::kFailed);
  }
  if (!loss) lab::write_aura_radius(arguments.out, arguments.plan.substeps);
  const std::vector<lab::Target> targets = lab::summarise(campaign, arguments.out);
  print(targets);
  return static_cast<int>(all_met(targets) ? command_line::ExitCode::kOk : command_line::ExitCode::kFailed);
}

void add_trials(CLI::App& parent, command_line::Action& action, const std::string& name, const std::string& about,
                bool loss) {
  CLI::App* command = parent.add_subcommand(name, about);
  const auto a = std::make_shared<TrialArguments>();
  a->pairs = loss ? std::vector<std::string>{"head_on"}
                  : std::vector<std::string>{"head_on", "corner", "grazing", "boxes", "capsules", "random"};
  a->auras = {"none", "thesis", "tight", "tight_at_thesis_size", "swept"};
  a->syncs = {"free_running", "bounded"};
  command->add_option("--out", a->out, "folder for the results; one that holds part of them is completed")->required();
  command->add_flag("--virtual", a->in_virtual_time,
                    "nodes and network in virtual time; otherwise in real time over DDS on loopback");
  command->add_option("--domain", a->domain, "of DDS, without --virtual")->check(CLI::Range(0, 232));
  command->add_option("--pairs", a->pairs, "which pairs fly at each other")
      ->delimiter(',')
      ->check(CLI::IsMember({"head_on", "corner", "grazing", "boxes", "capsules", "random"}));
  command->add_option("--aura", a->auras, "auras to try")
      ->delimiter(',')
      ->check(CLI::IsMember({"none", "thesis", "tight", "tight_at_thesis_size", "swept"}));
  command->add_option("--sync", a->syncs, "ways to wait to try")
      ->delimiter(',')
      ->check(CLI::IsMember({"free_running", "bounded", "deterministic"}));
  command->add_option("--repeats", a->plan.repeats, "pairs for each value")->check(CLI::Range(1, 100000));
  command->add_option("--substeps", a->plan.substeps, "physics substeps in each step")->check(CLI::Range(1, 16));
  command->add_option("--seed", a->plan.seed, "of all that is random");
  command->add_option("--threads", a->threads, "threads, in virtual time")->check(CLI::Range(1, 64));
  command
      ->add_option("--head-on-values", a->plan.values_of_head_on_pairs,
                   "values of each series for head-on pairs, evenly spread (0: all)")
      ->check(CLI::Range(0, 1000));
  if (!loss) {
    command
        ->add_option("--values", a->plan.values_of_other_pairs,
                     "values of each series for pairs that are not head-on (0: all)")
        ->check(CLI::Range(0, 1000));
  }
  command->footer(fmt::format("Example:\n  aurasim-lab experiment {} --virtual --repeats 20 --out out", name));
  command->callback([a, loss, &action] { action = [a, loss] { return run_trials(*a, loss); }; });
}

}  // namespace

void add_experiment(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("experiment", "the laboratory: the thesis's experiments");
  command->require_subcommand(1);
  command->footer("Example:\n  aurasim-lab experiment collision --virtual --repeats 20 --out out");
  add_trials(*command, action, "collision", "pairs that meet across a border: speed, latency, frame time", false);
  add_trials(*command, action, "loss", "the same with 0 to 20% of the datagrams lost", true);
  add_stability(*command, action);
  add_pareto(*command, action);
  add_scalability(*command, action);
  add_bandwidth(*command, action);
  add_scenes(*command, action);
  add_endurance(*command, action);
  add_speed(*command, action);
  add_speed_errors(*command, action);
}

}  // namespace aurasim::lab::commands
