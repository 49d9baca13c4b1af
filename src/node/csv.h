// Comma-separated numbers and names, as the recorder writes them: no quotes, one header line.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace aurasim::node {

/// What a cell says as a number; 0 when it says none.
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

/// Calls `row(cells)` for each complete line after the header. A file that is not there has no rows; a last line cut
/// off by a crash is left out.
template <class Row>
void read_csv(const std::filesystem::path& file, Row&& row) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line)) return;
  std::vector<std::string_view> cells;
  while (std::getline(in, line)) {
    if (in.eof()) return;
    cells.clear();
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      cells.push_back(std::string_view(line).substr(begin, end - begin));
      begin = end + 1;
    }
    row(cells);
  }
}

}  // namespace aurasim::node
