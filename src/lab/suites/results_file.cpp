#include "lab/suites/results_file.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace aurasim::lab {
namespace {

using Json = nlohmann::ordered_json;

std::string machine_here() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, model = "unknown processor";
  while (std::getline(info, line)) {
    if (line.rfind("model name", 0) != 0) continue;
    model = line.substr(std::min(line.size(), line.find(':') + 2));
    break;
  }
  return fmt::format("{} cores, {}", std::thread::hardware_concurrency(), model);
}

/// Six digits, as the results of two compilers agree in. JSON has no NaN and no infinity, so these become null.
Json rounded_value(double value) {
  return std::isfinite(value) ? Json::parse(fmt::format("{:.6g}", value)) : Json(nullptr);
}

struct Stored {
  double value = 0;
  std::string commit;
};
using StoredRows = std::map<std::pair<std::string, std::string>, Stored>;

StoredRows newest_full_rows(const std::filesystem::path& file) {
  StoredRows rows;
  std::ifstream in(file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    try {
      const Json row = Json::parse(line);
      if (row.at("run") != "full" || row.at("value").is_null()) continue;
      rows[{row.at("case"), row.at("metric")}] = {row.at("value"), row.at("commit")};
    } catch (const Json::exception& error) {
      throw std::runtime_error(fmt::format("{}:{}: not a row of results: {}", file.string(), number, error.what()));
    }
  }
  return rows;
}

}  // namespace

double tolerance_of(const ResultRow& row) {
  const auto is = [&](const char* unit) { return row.unit == unit; };
  if (is("us") || is("ms") || is("s")) return 0.5;
  return is("ratio") ? 0.3 : 0.01;
}

Provenance provenance_here(std::string commit, bool quick) {
  return {std::move(commit), fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr))), machine_here(), quick};
}

void append_results(const std::filesystem::path& file, const std::vector<ResultRow>& rows, const Provenance& from) {
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::app);
  for (const ResultRow& row : rows) {
    const Json line = {{"case", row.what},
                       {"metric", row.metric},
                       {"value", rounded_value(row.value)},
                       {"unit", row.unit},
                       {"n", row.n},
                       {"commit", from.commit},
                       {"date", from.date},
                       {"machine", from.machine},
                       {"run", from.quick ? "quick" : "full"}};
    out << line.dump() << "\n";
  }
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

std::vector<Difference> differences(const std::filesystem::path& file, const std::vector<ResultRow>& rows) {
  const StoredRows stored = newest_full_rows(file);
  std::vector<Difference> found;
  for (const ResultRow& row : rows) {
    const auto there = stored.find({row.what, row.metric});
    if (there == stored.end()) continue;
    const double before = there->second.value;
    const double larger = std::max(std::abs(row.value), std::abs(before));
    const bool is_near = std::abs(row.value - before) <= tolerance_of(row) * larger;  // false for NaN
    if (!is_near) found.push_back({row, before, there->second.commit});
  }
  return found;
}

}  // namespace aurasim::lab
