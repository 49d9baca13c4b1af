#include "lab/scale/layout.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace aurasim::lab {

std::string Layout::name() const {
  const char* kinds[] = {"columns", "grid", "corner"};
  return fmt::format("{}_{}x{:g}", kinds[static_cast<std::size_t>(kind)], count, cell_m);
}

std::string Layout::yaml() const {
  switch (kind) {
    case Kind::kColumns:
      return fmt::format("{{layout: columns, count: {}, width: {}}}", count, cell_m);
    case Kind::kGrid: {
      const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(count))));
      if (side * side != count) throw std::invalid_argument("a grid has as many rows as columns: 4, 9, 16");
      return fmt::format("{{layout: grid, rows: {0}, columns: {0}, cell: [{1}, {1}]}}", side, cell_m);
    }
    case Kind::kCorner:
      if (count != 3) throw std::invalid_argument("a corner has three regions");
      return fmt::format("{{layout: boxes, boxes: [[-{0}, -{0}, 0, 0], [0, -{0}, {0}, 0], [-{0}, 0, {0}, {0}]]}}",
                         cell_m);
  }
  throw std::logic_error("no such layout");
}

}  // namespace aurasim::lab
