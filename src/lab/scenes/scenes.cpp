#include "lab/scenes/scenes.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lab/scenes/random_world.h"
#include "lab/scenes/shrink.h"
#include "records/csv.h"

namespace aurasim::lab {
namespace {

/// seeds.csv: one seed.
struct SeedRow : WorldOutcome {
  std::uint64_t seed = 0;

  static constexpr auto columns() {
    using records::Column;
    return std::tuple{Column{"seed", &SeedRow::seed},
                      Column{"equal", [](const SeedRow& row) { return row.is_equal(); }},
                      Column{"first_difference", &SeedRow::first_difference},
                      Column{"late", &SeedRow::late},
                      Column{"missed", &SeedRow::missed},
                      Column{"unflagged", &SeedRow::unflagged},
                      Column{"unflagged_on_one", &SeedRow::unflagged_on_one},
                      Column{"violations", &SeedRow::violations},
                      Column{"speed", &SeedRow::speed},
                      Column{"latency", &SeedRow::latency},
                      Column{"promise", &SeedRow::promise},
                      Column{"span", &SeedRow::span},
                      Column{"redos", &SeedRow::redos},
                      Column{"computed_again", &SeedRow::computed_again},
                      Column{"hand_offs", &SeedRow::hand_offs},
                      Column{"broken", &SeedRow::broken},
                      Column{"regions", &SeedRow::regions},
                      Column{"bodies", &SeedRow::bodies},
                      Column{"largest_cluster", &SeedRow::largest_cluster},
                      Column{"regions_s", &SeedRow::regions_s, "{:.3f}"},
                      Column{"one_s", &SeedRow::one_s, "{:.3f}"},
                      Column{"error", &SeedRow::error}};
  }
};

SeedRow row_of(std::uint64_t seed, const WorldOutcome& outcome) {
  SeedRow row{outcome, seed};
  std::ranges::replace_if(
      row.error, [](char c) { return c == ',' || c == '\n'; }, ';');
  return row;
}

const char* network_of(const TrialRules& rules) {
  return rules.partitions ? "cut" : rules.bad_network ? "bad" : "good";
}

std::string shown_rules(const ScenesPlan& plan) {
  nlohmann::json rules = {{"experiment", "scenes"},
                          {"steps", plan.rules.steps},
                          {"sync", name_of(plan.rules.sync)},
                          {"network", network_of(plan.rules)},
                          {"overrides", plan.rules.overrides}};
  if (plan.rules.save_at) rules.update({{"save_at", *plan.rules.save_at}, {"load_on", plan.rules.load_on}});
  if (plan.rules.deaths > 0) rules["deaths"] = plan.rules.deaths;
  return rules.dump(1) + "\n";
}

/// Checks that the folder's seeds were run by the same rules. Their range may differ.
void agree_on_rules(const ScenesPlan& plan, const std::filesystem::path& directory) {
  std::filesystem::create_directories(directory);
  const std::filesystem::path file = directory / "campaign.json";
  std::ifstream in(file);
  std::stringstream found;
  found << in.rdbuf();
  if (in.is_open() && found.str() != shown_rules(plan)) {
    throw std::runtime_error(
        fmt::format("{} holds seeds that were run by other rules (campaign.json differs); choose another --out or "
                    "remove it",
                    directory.string()));
  }
  std::ofstream(file) << shown_rules(plan);
}

std::map<std::uint64_t, SeedRow> read_rows(const std::filesystem::path& file) {
  std::map<std::uint64_t, SeedRow> rows;
  records::read_csv<SeedRow>(file, [&](const SeedRow& row) { rows[row.seed] = row; });
  return rows;
}

/// seeds.csv, to which rows are appended.
class SeedFile {
 public:
  explicit SeedFile(const std::filesystem::path& file) : done_(read_rows(file)) {
    std::string text = records::csv_header<SeedRow>();
    for (const auto& [seed, row] : done_) text += records::csv_line(row);
    std::ofstream(file) << text;  // without a row that a crash has cut off
    out_.open(file, std::ios::app);
  }

  std::vector<std::uint64_t> missing(std::uint64_t first, std::uint64_t last) const {
    std::vector<std::uint64_t> seeds;
    for (std::uint64_t seed = first; seed <= last; ++seed) {
      if (!done_.contains(seed)) seeds.push_back(seed);
    }
    return seeds;
  }
  void append(const SeedRow& row) {
    const std::lock_guard lock(mutex_);
    out_ << records::csv_line(row);
    if (!out_.flush()) throw std::runtime_error("cannot write seeds.csv");
  }

 private:
  std::map<std::uint64_t, SeedRow> done_;
  std::mutex mutex_;
  std::ofstream out_;
};

void write_readme(const Shrunk& shrunk, const TrialRules& rules, std::uint64_t seed,
                  const std::filesystem::path& directory) {
  const WorldOutcome& o = shrunk.outcome;
  const std::string failure = !o.error.empty() ? o.error
                              : o.first_difference
                                  ? fmt::format("state {} has other bits than on one node", *o.first_difference)
                                  : fmt::format("{} late or missed collisions without a flag", o.unflagged);
  std::string command =
      fmt::format("aurasim-lab experiment scenes --case . --network-seed {} --steps {} --sync {} --network {}", seed,
                  shrunk.steps, name_of(rules.sync), network_of(rules));
  if (rules.save_at) {
    command += fmt::format(" --save-at {} --load-on {}", *rules.save_at, fmt::join(rules.load_on, ","));
  }
  if (rules.deaths > 0) command += fmt::format(" --deaths {}", rules.deaths);
  for (const std::string& change : rules.overrides) command += " --set " + change;
  std::ofstream(directory / "README.md")
      << fmt::format("Seed {}, shrunk to {} bodies in {} trials: {}.\n\n    {}\n\n", seed,
                     shrunk.world.scene["bodies"].size(), shrunk.trials, failure, command)
      << "runs it in virtual time. `aurasim launch launch.yaml` runs it on real nodes (without interference.json).\n";
}

/// Outcome of a seed's world. Files that cannot be read count as this seed's failure, so that the other seeds go on.
std::optional<WorldOutcome> outcome_in(const std::filesystem::path& folder, const TrialRules& rules, std::uint64_t seed,
                                       const std::atomic<bool>& stop) {
  try {
    return run_world(folder, rules, seed, stop);
  } catch (const std::exception& error) {
    WorldOutcome outcome;
    outcome.error = error.what();
    return outcome;
  }
}

/// Runs one seed. Its folder stays if the seed fails, or if the process crashes in it.
std::optional<SeedRow> run_seed(const ScenesPlan& plan, std::uint64_t seed, const std::filesystem::path& directory,
                                const std::atomic<bool>& stop) {
  const World world = random_world(seed);
  const std::filesystem::path folder = directory / fmt::format("seed_{}", seed);
  write_world(world, folder);
  const std::optional<WorldOutcome> outcome = outcome_in(folder, plan.rules, seed, stop);
  if (!outcome || (!outcome->has_failed() && !plan.keep)) std::filesystem::remove_all(folder);
  if (!outcome) return std::nullopt;
  if (outcome->has_failed() && plan.shrink_s > 0) {
    const std::filesystem::path small = folder / "shrunk";
    const Shrunk shrunk = shrink(world, *outcome, plan.rules, seed, plan.shrink_s, small, stop);
    write_world(shrunk.world, small);
    write_readme(shrunk, plan.rules, seed, small);
  }
  return row_of(seed, *outcome);
}

}  // namespace

bool run_scenes(const ScenesPlan& plan, const std::filesystem::path& directory, int threads, const Progress& progress,
                const std::atomic<bool>& stop) {
  agree_on_rules(plan, directory);
  SeedFile file(directory / "seeds.csv");
  const std::vector<std::uint64_t> seeds = file.missing(plan.first, plan.last);
  const bool finished =
      on_threads(threads, std::vector<double>(seeds.size(), 1), progress, [&](const WorkPiece& piece) {
        if (stop) return;
        const std::uint64_t seed = seeds[piece.index];
        if (const auto row = run_seed(plan, seed, directory, stop)) file.append(*row);
      });
  return finished && !stop;
}

nlohmann::json summarise_scenes(const ScenesPlan& plan, const std::filesystem::path& directory) {
  nlohmann::json sums = nlohmann::json::parse(shown_rules(plan));
  nlohmann::json failed = nlohmann::json::array();
  std::uint64_t seeds = 0, differ = 0, differ_unflagged = 0, late = 0, missed = 0, unflagged = 0, hand_offs = 0;
  std::uint64_t redos = 0, seeds_with_redos = 0, computed_again = 0;
  std::uint64_t with_violations = 0, errors = 0;
  double regions_s = 0, one_s = 0;
  for (const auto& [seed, row] : read_rows(directory / "seeds.csv")) {
    if (seed < plan.first || seed > plan.last) continue;
    ++seeds;
    differ += !row.is_equal();
    differ_unflagged += !row.is_equal() && (row.unflagged > row.unflagged_on_one || row.violations == 0);
    late += row.late, missed += row.missed, unflagged += row.unflagged, hand_offs += row.hand_offs;
    redos += row.redos, seeds_with_redos += row.redos > 0, computed_again += row.computed_again;
    with_violations += row.violations > 0;
    errors += !row.error.empty();
    regions_s += row.regions_s, one_s += row.one_s;
    if (row.has_failed()) failed.push_back(seed);
  }
  sums.update({{"seeds", seeds},
               {"differ", differ},
               {"differ_without_a_flag", differ_unflagged},
               {"errors", errors},
               {"late", late},
               {"missed", missed},
               {"unflagged", unflagged},
               {"seeds_with_violations", with_violations},
               {"redos", redos},
               {"seeds_with_redos", seeds_with_redos},
               {"states_computed_again", computed_again},
               {"hand_offs", hand_offs},
               {"cpu_s_on_regions", regions_s},
               {"cpu_s_on_one_node", one_s},
               {"failed_seeds", failed}});
  std::ofstream(directory / "summary.json") << sums.dump(1) << "\n";
  return sums;
}

}  // namespace aurasim::lab
