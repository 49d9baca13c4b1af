// The `regions` block of a launch file and the `layout` block of a scene:
//   {layout: columns, count: 4, width: 40}
//   {layout: grid, rows: 2, columns: 2, cell: [40, 40]}      (brick: the same, odd rows shifted by half a cell)
//   {layout: boxes, boxes: [[x0, y0, x1, y1], ...]}
// `count: 1` is the central run, in every layout, and needs nothing else. A grid or brick may give `count` instead of
// rows and columns: the most square grid of so many cells.
#pragma once

#include <optional>
#include <vector>

#include "config/fields.h"
#include "config/yaml_tree.h"
#include "core/region_map.h"

namespace aurasim::config {

inline constexpr std::int64_t kMostRegions = 1024;
/// Boxes are checked against each other one by one.
inline constexpr std::size_t kMostBoxes = 256;

struct RegionLayout {
  core::RegionMap map = core::RegionMap::columns(1, 1);
  /// The regions before the outermost were extended to infinity. Columns are as deep as they are wide.
  std::vector<core::Rectangle> tiles;
};

/// Asks for the keys of the layout; the caller may ask for more, and closes the map.
std::optional<RegionLayout> read_layout(Fields& fields);

/// After overrides: forgets what the file says where an override of `layout`, `count`, `rows` or `columns` has made
/// it meaningless, so that "--set regions.layout=columns --set regions.count=4 --set regions.width=40" suffices.
void settle_overridden_layout(YamlNode& regions);

}  // namespace aurasim::config
