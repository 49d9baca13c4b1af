// The `regions` block of a launch file and the `layout` block of a scene. `count: 1` is the central run, in every
// layout, and needs nothing else.
#pragma once

#include <optional>
#include <vector>

#include "config/fields.h"
#include "config/yaml_tree.h"
#include "core/region_map.h"

namespace aurasim::config {

inline constexpr std::int64_t kMostRegions = 1024;
/// Most boxes of a layout, because they are checked pair by pair.
inline constexpr std::size_t kMostBoxes = 256;

struct RegionLayout {
  core::RegionMap map = core::RegionMap::columns(1, 1);
  /// The regions before the outermost ones were extended to infinity. Columns are as deep as they are wide.
  std::vector<core::Rectangle> tiles;
};

/// Description of a layout for the tables of keys: a map with the keys of one of the layouts.
Value layout_value();

/// Reads a whole map that `layout_value` describes.
std::optional<RegionLayout> read_layout(const Field& map);

/// Drops, after overrides, values of the file that an override of `layout`, `count`, `rows` or `columns` has made
/// meaningless, so that "--set regions.layout=columns --set regions.count=4 --set regions.width=40" suffices.
void settle_overridden_layout(YamlNode& regions);

}  // namespace aurasim::config
