// Rows of comma-separated numbers and names under one header line, no quotes. The row's type defines its contents and
// the names of its columns:
//
//   struct Birth {
//     RegionId region{};
//     double mass_kg = 0;
//     static constexpr auto columns() {
//       return std::tuple{Column{"region", &Birth::region}, Column{"mass_kg", &Birth::mass_kg, "{:.3f}"}};
//     }
//   };
//
// Columns are written in that order and read by name. A file may have them in any order, and may have further columns.
#pragma once

#include <algorithm>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace aurasim::records {

/// A number in 16 hexadecimal digits.
enum class Hex64 : std::uint64_t {};

/// One column. `access` is a member, or a callable that takes a row. If the callable returns no reference, the column
/// is derived from others: it is written but not read.
template <class Access>
struct Column {
  constexpr Column(std::string_view column_name, Access column_access, std::string_view cell_format = "{}")
      : name(column_name), access(column_access), format(cell_format) {}

  std::string_view name;
  Access access;
  std::string_view format;  ///< format string of fmt
};

template <class Value>
void write_cell(std::string& out, const Value& value, std::string_view format) {
  if constexpr (std::same_as<Value, Hex64>) {
    fmt::format_to(std::back_inserter(out), "{:016x}", static_cast<std::uint64_t>(value));
  } else if constexpr (std::same_as<Value, bool>) {
    out += value ? '1' : '0';
  } else if constexpr (std::is_enum_v<Value>) {
    fmt::format_to(std::back_inserter(out), "{}", static_cast<std::underlying_type_t<Value>>(value));
  } else {
    fmt::format_to(std::back_inserter(out), fmt::runtime(format), value);
  }
}

/// Writes an optional value; an empty cell means that there is none.
template <class Value>
void write_cell(std::string& out, const std::optional<Value>& value, std::string_view format) {
  if (value) write_cell(out, *value, format);
}

/// Reads a cell into `value`. False if the cell is no such value.
template <class Value>
bool read_cell(std::string_view cell, Value& value) {
  if constexpr (std::same_as<Value, std::string_view> || std::same_as<Value, std::string>) {
    value = cell;
    return true;
  } else if constexpr (std::same_as<Value, bool>) {
    value = cell == "1";
    return cell == "1" || cell == "0";
  } else if constexpr (std::is_enum_v<Value>) {
    std::underlying_type_t<Value> number{};
    const int base = std::same_as<Value, Hex64> ? 16 : 10;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number, base);
    value = Value{number};
    return error == std::errc() && end == cell.data() + cell.size();
  } else {
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    return error == std::errc() && end == cell.data() + cell.size();
  }
}

template <class Value>
bool read_cell(std::string_view cell, std::optional<Value>& value) {
  value.reset();
  return cell.empty() || read_cell(cell, value.emplace());
}

/// The names of a row's columns, and the end of the line.
template <class Row>
std::string csv_header() {
  std::string line;
  std::apply([&](const auto&... column) { ((line.append(column.name) += ','), ...); }, Row::columns());
  line.back() = '\n';
  return line;
}

/// One row, and the end of the line.
template <class Row>
std::string csv_line(const Row& row) {
  std::string line;
  std::apply(
      [&](const auto&... column) {
        ((write_cell(line, std::invoke(column.access, row), column.format), line += ','), ...);
      },
      Row::columns());
  line.back() = '\n';
  return line;
}

/// The cells of a line, without its end.
inline void split_cells(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
}

/// Reads rows of one type from the lines of a file, whose header gives the places of the columns.
template <class Row>
class CsvReader {
 public:
  /// Throws std::runtime_error if the header lacks a column that is read.
  CsvReader(std::string_view header, std::string_view file_name) {
    split_cells(header, cells_);
    width_ = cells_.size();
    std::apply([&](const auto&... column) { (find(column, file_name), ...); }, Row::columns());
  }

  /// False if the line is not such a row. Text in the row is valid as long as the line.
  bool read(std::string_view line, Row& row) {
    split_cells(line, cells_);
    if (cells_.size() != width_) return false;
    std::size_t at = 0;
    return std::apply([&](const auto&... column) { return (take(column, at++, row) && ...); }, Row::columns());
  }

 private:
  template <class Access>
  static constexpr bool kIsRead = std::is_lvalue_reference_v<std::invoke_result_t<Access, Row&>>;

  template <class Access>
  void find(const Column<Access>& column, std::string_view file_name) {
    const auto found = std::find(cells_.begin(), cells_.end(), column.name);
    if (kIsRead<Access> && found == cells_.end()) {
      throw std::runtime_error(fmt::format("{}: no column {}", file_name, column.name));
    }
    places_.push_back(static_cast<std::size_t>(found - cells_.begin()));
  }

  template <class Access>
  bool take(const Column<Access>& column, std::size_t at, Row& row) const {
    if constexpr (kIsRead<Access>) return read_cell(cells_[places_[at]], std::invoke(column.access, row));
    return true;
  }

  std::size_t width_ = 0;
  std::vector<std::size_t> places_;  ///< place in the line, by column of the row
  std::vector<std::string_view> cells_;
};

/// Calls `visit(row)` for each complete line after the header, and returns how many of these lines were no such row. A
/// file that is not there has no rows; a last line cut off by a crash is left out. Throws std::runtime_error if a
/// column is missing.
template <class Row, class Visit>
std::size_t read_csv(const std::filesystem::path& file, Visit&& visit) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line) || in.eof()) return 0;
  CsvReader<Row> reader(line, file.string());
  std::size_t broken = 0;
  while (std::getline(in, line) && !in.eof()) {
    Row row;
    if (reader.read(line, row)) {
      visit(std::as_const(row));
    } else {
      ++broken;
    }
  }
  return broken;
}

/// Value of a cell as a number; 0 if the cell is no number.
inline double number(std::string_view text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

inline std::uint64_t whole(std::string_view text, int base = 10) {
  std::uint64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value, base);
  return value;
}

/// Calls `row(cells)` for each complete line after the header.
template <class Row>
void read_csv(const std::filesystem::path& file, Row&& row) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line)) return;
  std::vector<std::string_view> cells;
  while (std::getline(in, line) && !in.eof()) {
    split_cells(line, cells);
    row(cells);
  }
}

}  // namespace aurasim::records
