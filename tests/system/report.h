// What a run has left on disk, read back.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace aurasim::system_test {

/// A CSV file: one header line, cells without quotes.
class Table {
 public:
  explicit Table(const std::filesystem::path& file);

  const std::string& header() const { return header_; }
  std::size_t rows() const { return rows_.size(); }
  /// Cell of a row in the column of that name. Throws std::out_of_range if there is none.
  const std::string& text(std::size_t row, const std::string& column) const;
  std::int64_t whole(std::size_t row, const std::string& column) const { return std::stoll(text(row, column)); }
  double number(std::size_t row, const std::string& column) const { return std::stod(text(row, column)); }

 private:
  std::string header_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

class Report {
 public:
  explicit Report(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path region_folder(int region) const { return folder_ / ("region_" + std::to_string(region)); }

  nlohmann::json summary() const;
  /// One entry of the summary, as a value: a loop over it outlives the summary.
  nlohmann::json entry(const char* key) const { return summary().at(key); }
  std::int64_t count(const char* key) const { return entry(key).get<std::int64_t>(); }

  Table steps() const { return Table(folder_ / "steps.csv"); }
  Table collisions() const { return Table(folder_ / "collisions.csv"); }
  Table migrations() const { return Table(folder_ / "migrations.csv"); }
  std::string state_hash() const;

  /// The last step that a node has written down so far; -1 before the first. For a run that is still going on.
  std::int64_t recorded_step(int region) const;

 private:
  std::filesystem::path folder_;
};

/// Where two lists of hashes part; empty if they are equal.
std::string first_difference(const std::string& a, const std::string& b);

}  // namespace aurasim::system_test
