// Comma-separated numbers and names, as the recorder writes them: no quotes, one header line.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace aurasim::node {

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
