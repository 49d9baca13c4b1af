#include "records/report.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "records/durations.h"
#include "records/recorder.h"
#include "records/report_rows.h"
#include "records/row_file.h"
#include "records/setpoint_record.h"
#include "records/thrashing.h"

namespace aurasim::records {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMostSteps = 1'000'000'000;  // upper bound of a run's steps; a row with a higher step is broken
constexpr std::size_t kSummaryBytes = 32 * 1024;     // room reserved for summary.json, enough for many regions

/// A change of host, put together from the records.
struct Move {
  std::uint64_t stamp = 0;
  std::uint64_t body = 0;
  std::uint64_t epoch = 0;
  std::uint64_t source = 0;
  std::uint64_t destination = 0;
  bool pulled = false;  ///< the reason was an aura collision
  bool touched = true;
  bool adopted = false;  ///< its arrival is recorded, too

  bool is_pull() const { return pulled; }
};

std::filesystem::path of_region(const std::filesystem::path& folder, std::size_t region, const char* name) {
  return Recorder::region_folder(folder, core::RegionId{static_cast<std::uint32_t>(region)}) / name;
}

/// node.json, which a node wrote when it ended.
Json last_word_of(const std::filesystem::path& folder, std::size_t region) {
  std::ifstream in(of_region(folder, region, "node.json"));
  Json node = in ? Json::parse(in, nullptr, false) : Json();
  return node.is_object() ? node : Json{{"region", region}, {"outcome", "died"}};
}

class Merge {
 public:
  Merge(const std::filesystem::path& folder, const RunFacts& facts) : folder_(folder), facts_(facts) {}

  Accounts run() {
    for (const char* name : {"steps.csv", "collisions.csv", "migrations.csv", "violations.csv", kSetpointsFile}) {
      if (!join(name)) give_up(name);
    }
    read_nodes();
    read_moves();
    read_bodies();
    if (!add_hashes()) give_up("state_hash.csv");
    count_bodies();
    count_thrashing();
    write_summary();
    return accounts_;
  }

 private:
  bool died(std::uint64_t region) const {
    return std::any_of(facts_.died.begin(), facts_.died.end(),
                       [&](core::RegionId id) { return core::value_of(id) == region; });
  }

  bool join(const char* name) const {
    std::ofstream out(folder_ / name);
    bool header = false;
    for (std::size_t r = 0; r < facts_.regions; ++r) {
      std::ifstream in(of_region(folder_, r, name));
      std::string line;
      if (!std::getline(in, line)) continue;
      if (!header) out << line << '\n';
      header = true;
      while (out && std::getline(in, line) && !in.eof()) out << line << '\n';
    }
    return static_cast<bool>(out.flush());
  }

  /// Removes a merged file for which there was no room, because half a file would look like a whole one.
  void give_up(const char* name) {
    std::error_code ignored;
    std::filesystem::remove(folder_ / name, ignored);
    accounts_.not_merged.emplace_back(name);
  }

  /// Reads the rows of all regions, whether or not there was room for a merged file.
  template <class Row, class Visit>
  void read_all(const char* name, Visit&& visit) const {
    for (std::size_t r = 0; r < facts_.regions; ++r) read_csv<Row>(of_region(folder_, r, name), visit);
  }

  void read_moves() {
    std::map<std::pair<std::uint64_t, std::uint64_t>, Move> moves;  // key: body and epoch
    read_all<MigrationRow>("migrations.csv", [&](const MigrationRow& row) {
      Move& move = moves[{core::value_of(row.body), row.epoch}];
      const bool departure = row.direction == MigrationRow::kOut;
      move.stamp = static_cast<std::uint64_t>(row.stamp);
      move.body = core::value_of(row.body);
      move.epoch = row.epoch;
      move.source = core::value_of(row.source);
      move.destination = core::value_of(row.destination);
      move.pulled = row.reason == MigrationRow::kAuraCollision;
      if (departure) move.touched = row.touched;
      move.adopted = move.adopted || !departure;
    });
    for (const auto& [key, move] : moves) {
      moves_[move.body].push_back(move);
      first_host_.try_emplace(move.body, move.source);
    }
  }

  void read_bodies() {
    for (std::size_t r = 0; r < facts_.regions; ++r) {
      read_csv<BirthRow>(of_region(folder_, r, "births.csv"), [&](const BirthRow& row) {
        first_host_.try_emplace(core::value_of(row.body), core::value_of(row.region));
      });
      read_csv<RemovalRow>(of_region(folder_, r, "removals.csv"),
                           [&](const RemovalRow& row) { removed_.insert(core::value_of(row.body)); });
      // Bodies that a fenced node still records as its own have other hosts by now, or are written off.
      read_csv<BodyRow>(of_region(folder_, r, "bodies.csv"), [&](const BodyRow& row) {
        if (died(r)) return;
        if (row.where == BodyRow::kHere) ++hosts_[core::value_of(row.body)];
        alive_.insert(core::value_of(row.body));
      });
    }
    for (const std::uint64_t body : alive_) first_host_.try_emplace(body, 0);
  }

  void read_nodes() {
    for (std::size_t r = 0; r < facts_.regions; ++r) {
      const Json& node = nodes_.emplace_back(last_word_of(folder_, r));
      if (!node.contains("records_end")) continue;
      const Json& end = node["records_end"];
      accounts_.incomplete.push_back({core::RegionId{static_cast<std::uint32_t>(r)},
                                      end.value("after_step", std::uint64_t{0}), end.value("why", std::string())});
    }
  }

  bool add_hashes() const {
    std::vector<std::optional<std::uint64_t>> sums;  // by step
    read_all<HashRow>("state_hash.csv", [&](const HashRow& row) {
      const auto step = static_cast<std::uint64_t>(row.step);
      if (step > kMostSteps) return;
      if (step >= sums.size()) sums.resize(step + 1);
      sums[step] = sums[step].value_or(0) + static_cast<std::uint64_t>(row.hash);
    });
    std::ofstream out(folder_ / "state_hash.csv");
    out << csv_header<HashRow>();
    for (std::size_t step = 0; step < sums.size(); ++step) {
      if (sums[step]) out << csv_line(HashRow{static_cast<core::Step>(step), Hex64{*sums[step]}});
    }
    return static_cast<bool>(out.flush());
  }

  void count_bodies() {
    for (const auto& [body, count] : hosts_) accounts_.duplicated += count > 1;
    for (const auto& [body, first] : first_host_) {
      if (alive_.contains(body) || removed_.contains(body)) continue;
      std::uint64_t host = first;
      std::uint64_t epoch = 0;
      for (const Move& move : moves_[body]) {
        // Bodies that a node had sent, but that no node adopted before it died, count as gone with it.
        const bool dropped = !move.adopted && died(move.source);
        if (move.epoch > epoch) host = dropped ? move.source : move.destination;
        epoch = std::max(epoch, move.epoch);
      }
      if (died(host)) {
        with_dead_[host].push_back(body);
      } else if (!accounts_.incomplete.empty()) {
        ++accounts_.unaccounted;
      } else {
        ++accounts_.lost;
        lost_.push_back(body);
      }
    }
  }

  void count_thrashing() {
    for (auto& [body, moves] : moves_) {
      std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) { return a.epoch < b.epoch; });
      for (std::size_t i = 0; i < moves.size(); ++i) {
        ++accounts_.hand_offs;
        accounts_.thrashed += i > 0 && is_thrashing(moves[i - 1], moves[i]);
      }
    }
  }

  Json frame_times() const {
    std::map<std::uint64_t, std::map<std::string, std::vector<double>>> columns;
    const std::vector<std::pair<std::string, double StepRow::*>> wanted = {{"frame_ms", &StepRow::frame_ms},
                                                                           {"wait_ms", &StepRow::wait_ms},
                                                                           {"physics_ms", &StepRow::physics_ms},
                                                                           {"protocol_ms", &StepRow::protocol_ms},
                                                                           {"transport_ms", &StepRow::transport_ms},
                                                                           {"cut_ms", &StepRow::cut_ms},
                                                                           {"hash_ms", &StepRow::hash_ms}};
    read_all<StepRow>("steps.csv", [&](const StepRow& row) {
      if (row.step == 0) return;
      for (const auto& [name, time] : wanted) columns[core::value_of(row.region)][name].push_back(row.*time);
    });
    Json regions = Json::array();
    for (auto& [region, times] : columns) {
      Json entry = {{"region", region}};
      for (auto& [name, values] : times) {
        const double p50 = percentile(values, 0.5);
        const double p99 = percentile(values, 0.99);
        entry[name] = {{"p50", p50}, {"p99", p99}, {"max", percentile(values, 1)}};
      }
      regions.push_back(entry);
    }
    return regions;
  }

  std::uint64_t sum_over_nodes(const char* key) const {
    std::uint64_t sum = 0;
    for (const Json& node : nodes_) sum += node.value(key, std::uint64_t{0});
    return sum;
  }

  void write_summary() {
    std::uint64_t violations = 0;
    double factor = 1e9;
    std::uint64_t steps = 0;
    for (const Json& node : nodes_) {
      if (!node.contains("violations")) continue;
      for (const auto& [kind, count] : node["violations"].items()) {
        accounts_.violations[kind] += count.get<std::uint64_t>();
        violations += count.get<std::uint64_t>();
      }
      factor = std::min(factor, node.value("real_time_factor", 0.0));
      steps = std::max(steps, node.value("steps", std::uint64_t{0}));
    }
    accounts_.real_time_factor = factor > 1e8 ? 0 : factor;
    accounts_.bodies = alive_.size();
    Json dead = Json::array();
    std::uint64_t with_dead = 0;
    for (const core::RegionId region : facts_.died) {
      const auto found = with_dead_.find(core::value_of(region));
      const std::vector<std::uint64_t> bodies =
          found == with_dead_.end() ? std::vector<std::uint64_t>{} : found->second;
      with_dead += bodies.size();
      accounts_.dead.push_back({region, bodies.size()});
      dead.push_back({{"region", core::value_of(region)}, {"bodies", bodies}});
    }
    const Json all_redos = redos();
    accounts_.redos = all_redos.size();
    accounts_.redo_share = redo_share();
    const Json summary = {
        {"steps", steps},
        {"step_s", facts_.step_s},
        {"real_time_factor", accounts_.real_time_factor},
        {"exchange", nodes_.empty() ? std::string() : nodes_.front().value("exchange", std::string())},
        {"bodies_spawned", first_host_.size()},
        {"bodies_removed", removed_.size()},
        {"bodies_alive", alive_.size()},
        {"bodies_lost", accounts_.lost},
        {"lost", lost_},
        {"bodies_duplicated", accounts_.duplicated},
        {"bodies_unaccounted", accounts_.unaccounted},
        {"bodies_with_dead_regions", with_dead},
        {"dead_regions", dead},
        {"incomplete_regions", incomplete_json()},
        {"not_merged", accounts_.not_merged},
        {"migrations", accounts_.hand_offs},
        {"thrashed", accounts_.thrashed},
        {"late_collisions", sum_over_nodes("late_collisions")},
        {"missed_collisions", sum_over_nodes("missed_collisions")},
        {"late_without_violation", sum_over_nodes("late_without_violation")},
        {"severed_contacts", sum_over_nodes("severed_contacts")},
        {"redos", all_redos},
        {"redo_share", accounts_.redo_share},
        {"violations", violations},
        {"violations_by_kind", accounts_.violations},
        {"regions", frame_times()},
        {"nodes", nodes_},
    };
    if (!overwrite(folder_ / "summary.json", summary.dump(2) + '\n')) {
      throw std::runtime_error(fmt::format("cannot write {}; what the nodes have written is in region_*",
                                           (folder_ / "summary.json").string()));
    }
  }

  /// The redos of the run. All nodes go back alike, so the node that recorded most of them has them all.
  Json redos() const {
    Json most = Json::array();
    for (const Json& node : nodes_) {
      if (node.contains("redos") && node["redos"].size() > most.size()) most = node["redos"];
    }
    return most;
  }

  /// The share of all nodes' computing time that went into going back and into states computed again.
  double redo_share() const {
    double all_s = 0, in_redos_s = 0;
    for (const Json& node : nodes_) {
      all_s += node.value("computing_s", 0.0);
      in_redos_s += node.value("in_redos_s", 0.0);
    }
    return all_s > 0 ? in_redos_s / all_s : 0;
  }

  Json incomplete_json() const {
    Json regions = Json::array();
    for (const IncompleteRegion& r : accounts_.incomplete) {
      regions.push_back({{"region", core::value_of(r.region)}, {"after_step", r.after_step}, {"why", r.why}});
    }
    return regions;
  }

  std::filesystem::path folder_;
  RunFacts facts_;
  std::map<std::uint64_t, std::vector<Move>> moves_;   ///< by body, ascending epoch
  std::map<std::uint64_t, std::uint64_t> first_host_;  ///< by body
  std::map<std::uint64_t, int> hosts_;                 ///< by body: how many nodes host it at the end
  std::set<std::uint64_t> alive_;
  std::set<std::uint64_t> removed_;                                ///< by orders
  std::map<std::uint64_t, std::vector<std::uint64_t>> with_dead_;  ///< by region
  std::vector<std::uint64_t> lost_;
  std::vector<Json> nodes_;
  Accounts accounts_;
};

}  // namespace

bool has_records(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) return false;
  const std::filesystem::directory_iterator entries(folder);
  return std::any_of(begin(entries), end(entries), [](const auto& entry) {
    return entry.path().filename().string().starts_with("region_") &&
           std::filesystem::exists(entry.path() / "steps.csv");
  });
}

void clear_report(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool region = name.starts_with("region_") && std::filesystem::exists(entry.path() / "steps.csv");
    const bool merged = name == "summary.json" || name == "steps.csv" || name == "collisions.csv" ||
                        name == "migrations.csv" || name == "violations.csv" || name == "state_hash.csv";
    if (region || merged) std::filesystem::remove_all(entry.path());
  }
}

void reserve_summary(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  reserve(folder / "summary.json", Json{{"outcome", "not merged"}}.dump(), kSummaryBytes);
}

std::vector<core::RegionId> regions_without_end(const std::filesystem::path& folder, std::size_t regions) {
  std::vector<core::RegionId> without;
  for (std::size_t r = 0; r < regions; ++r) {
    const std::string outcome = last_word_of(folder, r).value("outcome", "");
    if (outcome != "finished" && outcome != "broken off") {
      without.push_back(core::RegionId{static_cast<std::uint32_t>(r)});
    }
  }
  return without;
}

Accounts merge_report(const std::filesystem::path& folder, const RunFacts& facts) { return Merge(folder, facts).run(); }

}  // namespace aurasim::records
