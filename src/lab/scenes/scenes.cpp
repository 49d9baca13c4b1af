#include "lab/scenes/scenes.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lab/conditions.h"
#include "lab/on_threads.h"
#include "lab/scenes/random_world.h"
#include "lab/scenes/shrink.h"
#include "physics/region_world.h"
#include "records/csv.h"

namespace aurasim::lab {
namespace {

using Clock = std::chrono::steady_clock;

/// seeds.csv: one seed.
struct SeedRow {
  std::uint64_t seed = 0;
  bool equal = false;
  std::optional<core::Step> first_difference;
  std::uint64_t late = 0, missed = 0, unflagged = 0, unflagged_on_one = 0;
  std::uint64_t violations = 0, speed = 0, latency = 0, promise = 0, span = 0;
  std::uint64_t redos = 0, computed_again = 0;
  std::uint64_t hand_offs = 0, broken = 0;
  std::uint64_t regions = 0, bodies = 0, largest_cluster = 0;
  double regions_s = 0, one_s = 0;
  std::string error;

  bool has_failed() const { return !equal || unflagged > unflagged_on_one; }

  static constexpr auto columns() {
    using records::Column;
    return std::tuple{Column{"seed", &SeedRow::seed},
                      Column{"equal", &SeedRow::equal},
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

SeedRow row_of(std::uint64_t seed, const WorldOutcome& o) {
  SeedRow row;
  row.seed = seed;
  row.equal = o.is_equal();
  row.first_difference = o.first_difference;
  row.late = o.late, row.missed = o.missed, row.unflagged = o.unflagged, row.unflagged_on_one = o.unflagged_on_one;
  row.violations = o.violations, row.speed = o.speed, row.latency = o.latency, row.promise = o.promise;
  row.redos = o.redos, row.computed_again = o.computed_again;
  row.span = o.span, row.hand_offs = o.hand_offs, row.broken = o.broken;
  row.regions = o.regions, row.bodies = o.bodies, row.largest_cluster = o.largest_cluster;
  row.regions_s = o.regions_s, row.one_s = o.one_s;
  row.error = o.error;
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

/// Hands out the missing seeds and appends their rows.
class SeedQueue {
 public:
  SeedQueue(const ScenesPlan& plan, const std::filesystem::path& file, const std::function<void(const Progress&)>& show)
      : show_(show) {
    const std::map<std::uint64_t, SeedRow> done = read_rows(file);
    std::string text = records::csv_header<SeedRow>();
    for (const auto& [seed, row] : done) text += records::csv_line(row);
    std::ofstream(file) << text;  // without a row that a crash has cut off
    out_.open(file, std::ios::app);
    for (std::uint64_t seed = plan.first; seed <= plan.last; ++seed) {
      if (!done.contains(seed)) missing_.push_back(seed);
    }
    all_ = static_cast<double>(plan.last - plan.first + 1);
  }

  std::optional<std::uint64_t> take() {
    const std::lock_guard lock(mutex_);
    if (next_ == missing_.size()) return std::nullopt;
    return missing_[next_++];
  }

  void give(const SeedRow& row) {
    const std::lock_guard lock(mutex_);
    out_ << records::csv_line(row);
    if (!out_.flush()) throw std::runtime_error("cannot write seeds.csv");
    const auto now = static_cast<double>(++given_), left = static_cast<double>(missing_.size()) - now;
    const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
    show_({(all_ - left) / all_, elapsed, elapsed * left / now});
  }

 private:
  std::mutex mutex_;
  std::ofstream out_;
  std::vector<std::uint64_t> missing_;
  std::size_t next_ = 0, given_ = 0;
  double all_ = 0;
  Clock::time_point begin_ = Clock::now();
  const std::function<void(const Progress&)>& show_;
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

bool run_scenes(const ScenesPlan& plan, const std::filesystem::path& directory, int threads,
                const std::function<void(const Progress&)>& show, const std::atomic<bool>& stop) {
  agree_on_rules(plan, directory);
  SeedQueue queue(plan, directory / "seeds.csv", show);
  on_threads(threads, [&] {
    while (!stop) {
      const auto seed = queue.take();
      if (!seed) return;
      if (const auto row = run_seed(plan, *seed, directory, stop)) queue.give(*row);
    }
  });
  return !stop;
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
    differ += !row.equal;
    differ_unflagged += !row.equal && (row.unflagged > row.unflagged_on_one || row.violations == 0);
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
