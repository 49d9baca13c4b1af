#include "report.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "process.h"

namespace aurasim::system_test {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

Table::Table(const std::filesystem::path& file) {
  std::istringstream in(read_text(file));
  std::getline(in, header_);
  columns_ = split(header_);
  for (std::string line; std::getline(in, line);) rows_.push_back(split(line));
}

const std::string& Table::text(std::size_t row, const std::string& column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) throw std::out_of_range("no column " + column + " in: " + header_);
  return rows_.at(row).at(static_cast<std::size_t>(found - columns_.begin()));
}

nlohmann::json Report::summary() const { return nlohmann::json::parse(read_text(folder_ / "summary.json")); }

std::string Report::state_hash() const { return read_text(folder_ / "state_hash.csv"); }

std::int64_t Report::recorded_step(int region) const {
  const std::string text = read_text(region_folder(region) / "steps.csv");
  const std::size_t end = text.rfind('\n');
  if (end == std::string::npos) return -1;
  const std::size_t begin = text.rfind('\n', end - 1);
  if (begin == std::string::npos) return -1;  // only the header
  return std::stoll(split(text.substr(begin + 1, end - begin - 1)).at(1));
}

std::string first_difference(const std::string& a, const std::string& b) {
  std::istringstream in_a(a), in_b(b);
  std::string line_a, line_b;
  for (;;) {
    const bool more_a = static_cast<bool>(std::getline(in_a, line_a));
    const bool more_b = static_cast<bool>(std::getline(in_b, line_b));
    if (!more_a && !more_b) return {};
    if (more_a != more_b || line_a != line_b) return line_a + " and " + line_b;
  }
}

}  // namespace aurasim::system_test
