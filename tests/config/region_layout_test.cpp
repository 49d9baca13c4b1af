#include "config/workspace.h"

namespace aurasim::config {
namespace {

std::uint64_t version_of(const std::string& regions) {
  const Workspace workspace;
  return workspace.launch("scene: scene.yaml\nregions: " + regions + "\n").regions.version();
}

TEST(RegionLayout, EachKindGivesItsMap) {
  using core::RegionMap;
  EXPECT_EQ(version_of("{layout: columns, count: 4, width: 40}"), RegionMap::columns(4, 40).version());
  EXPECT_EQ(version_of("{count: 4, width: 40}"), RegionMap::columns(4, 40).version());
  EXPECT_EQ(version_of("{layout: grid, rows: 2, columns: 3, cell: [30, 40]}"), RegionMap::grid(2, 3, 30, 40).version());
  EXPECT_EQ(version_of("{layout: brick, rows: 3, columns: 2, cell: [30, 40]}"),
            RegionMap::brick(3, 2, 30, 40).version());
  EXPECT_EQ(version_of("{layout: boxes, boxes: [[0, 0, 40, 40], [40, 0, 80, 40]]}"),
            RegionMap::boxes({{0, 0, 40, 40}, {40, 0, 80, 40}}).version());
}

TEST(RegionLayout, ACentralRunNeedsNoSizes) {
  EXPECT_EQ(version_of("{count: 1}"), core::RegionMap::columns(1, 1).version());
  EXPECT_EQ(version_of("{layout: grid, count: 1}"), core::RegionMap::columns(1, 1).version());
  EXPECT_EQ(version_of("{layout: columns, count: 1, width: 0.1}"), core::RegionMap::columns(1, 1).version());
}

}  // namespace
}  // namespace aurasim::config
