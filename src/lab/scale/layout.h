// A division of the plane into regions. Its short name is, for example, "columns_4x80" (four columns of 80 m),
// "grid_9x80" or "corner_3x80" (three regions that meet in a point).
#pragma once

#include <cstddef>
#include <string>

namespace aurasim::lab {

struct Layout {
  enum class Kind { kColumns, kGrid, kCorner };
  Kind kind = Kind::kColumns;
  std::size_t count = 1;
  double cell_m = 80;

  std::string name() const;
  /// The text for `regions` of a launch file or `layout` of a scene. Throws std::invalid_argument for a grid that is
  /// not square, and for a corner of other than three regions.
  std::string yaml() const;
};

}  // namespace aurasim::lab
