#include "lab/suites/speed_rows.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

#include "lab/scale/fit.h"

namespace aurasim::lab {
namespace {

using Row = std::map<std::string, std::string>;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

/// A file of comma-separated values without quotes, whose first line names the columns.
std::vector<Row> read_rows(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line)) throw std::runtime_error("cannot read " + file.string());
  const std::vector<std::string> names = cells_of(line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() != names.size()) throw std::runtime_error(file.string() + ": malformed line: " + line);
    for (std::size_t i = 0; i < names.size(); ++i) (i == 0 ? rows.emplace_back() : rows.back())[names[i]] = cells[i];
  }
  return rows;
}

double number(const Row& row, const char* column) { return std::stod(row.at(column)); }

struct Error {
  const char* column;
  const char* metric;
  double scale;
  const char* unit;
};
constexpr Error kOverlap = {"overlap_m", "deepest overlap", 1e3, "mm"};
constexpr Error kInStatic = {"in_static_m", "deepest in the ground", 1e3, "mm"};
constexpr Error kSunk = {"sunk_m", "most sunk", 1e3, "mm"};
constexpr Error kDrift = {"drift_m", "farthest drift", 1, "m"};
constexpr Error kFallen = {"fallen", "fallen", 1, "1"};
constexpr Error kLost = {"lost", "lost", 1, "1"};
constexpr Error kEnergy = {"energy", "energy gained", 100, "%"};
constexpr Error kGap = {"joint_gap_m", "widest joint gap", 1e3, "mm"};
constexpr Error kTurn = {"hinge_turn_rad", "hinge off axis or limits", 1, "rad"};

/// What is told of a scene beside its speed.
const std::map<std::string, std::vector<Error>> kErrors = {{"rain", {kOverlap, kInStatic, kLost}},
                                                           {"pyramid", {kSunk, kOverlap, kDrift, kFallen}},
                                                           {"hulls", {kOverlap, kInStatic, kLost}},
                                                           {"ragdolls", {kGap, kTurn, kOverlap, kInStatic, kLost}},
                                                           {"card_houses", {kFallen, kSunk, kDrift, kOverlap}},
                                                           {"gas", {kEnergy, kOverlap, kLost}},
                                                           {"sleepers", {kSunk, kDrift, kOverlap}}};

/// All runs of one scene by one engine with one number of threads.
class Runs {
 public:
  void add(const Row& row) { rows_.push_back(row); }
  const Row& first() const { return rows_.front(); }
  int count() const { return static_cast<int>(rows_.size()); }

  double median_of(const char* what, const char* per) const {
    std::vector<double> values;
    for (const Row& row : rows_) values.push_back(number(row, what) / number(row, per));
    return median(values);
  }
  /// From the fastest run to the slowest, as a share of the median.
  double spread_percent() const {
    std::vector<double> values;
    for (const Row& row : rows_) values.push_back(number(row, "cpu_ms"));
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return 100 * (*most - *least) / median(values);
  }

 private:
  std::vector<Row> rows_;
};

std::string case_of(const Row& row) {
  const std::string threads = row.at("threads") == "1" ? "" : ", " + row.at("threads") + " threads";
  return row.at("scene") + threads + "/" + row.at("engine") + ", " + row.at("precision");
}

std::string alone(Row row) {
  row["threads"] = "1";
  return case_of(row);
}

void add_times(const Runs& runs, const std::map<std::string, Runs>& all, std::vector<ResultRow>& out) {
  const std::string what = case_of(runs.first());
  const int n = runs.count();
  out.push_back({what, "CPU", runs.median_of("cpu_ms", "steps"), "ms", n});
  if (runs.first().at("threads") == "1") {
    out.push_back({what, "CPU at the end", runs.median_of("late_cpu_ms", "late_steps"), "ms", n});
    out.push_back({what, "body-steps per CPU second", 1e3 * runs.median_of("body_steps", "cpu_ms"), "1", n});
    out.push_back({what, "spread of the CPU time", runs.spread_percent(), "%", n});
    return;
  }
  const double wall_ms = runs.median_of("wall_ms", "steps");
  out.push_back({what, "wall", wall_ms, "ms", n});
  const auto one = all.find(alone(runs.first()));
  if (one == all.end()) return;
  out.push_back({what, "faster by", one->second.median_of("wall_ms", "steps") / wall_ms, "ratio", n});
}

}  // namespace

std::vector<ResultRow> speed_rows(const std::filesystem::path& directory) {
  std::map<std::string, Runs> all;
  for (const Row& row : read_rows(directory / "runs.csv")) all[case_of(row)].add(row);
  std::vector<ResultRow> rows;
  for (const auto& [what, runs] : all) add_times(runs, all, rows);
  for (const Row& row : read_rows(directory / "errors.csv")) {
    const auto wanted = kErrors.find(row.at("scene"));
    if (wanted == kErrors.end()) continue;
    for (const Error& error : wanted->second) {
      rows.push_back({case_of(row), error.metric, error.scale * number(row, error.column), error.unit});
    }
  }
  return rows;
}

}  // namespace aurasim::lab
