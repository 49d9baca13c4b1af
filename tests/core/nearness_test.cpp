#include "core/nearness.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/seam_tree.h"

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

int hops_across(const RegionMap& map, double distance_m) { return core::hops_across(all_near(map, distance_m)); }

TEST(HopsAcross, CountsTheLongestWay) {
  const RegionMap six = RegionMap::columns(6, 10);
  EXPECT_EQ(hops_across(six, 1), 5);
  EXPECT_EQ(hops_across(six, 11), 3) << "each hears the one after the next, too";
  EXPECT_EQ(hops_across(six, 1e9), 1);
  EXPECT_EQ(hops_across(RegionMap::columns(1, 10), 1e9), 0);
}

TEST(HopsAcross, InAGridGoesCornerToCorner) {
  EXPECT_EQ(hops_across(RegionMap::grid(3, 3, 10, 10), 1), 2) << "over the corners";
}

TEST(HopsFrom, CountsTheWayFromOneRegion) {
  const auto near = all_near(RegionMap::columns(6, 10), 1);
  EXPECT_EQ(hops_from(RegionId{0}, near), 5);
  EXPECT_EQ(hops_from(RegionId{2}, near), 3);
}

TEST(SeamTree, IsNotNeededByFew) {
  EXPECT_FALSE(SeamTree(9).is_needed());
  EXPECT_TRUE(SeamTree(10).is_needed());
}

TEST(SeamTree, HasEachRegionOnce) {
  for (const std::uint32_t regions : {1U, 9U, 10U, 73U, 74U, 1000U}) {
    const SeamTree tree(regions);
    std::vector<std::uint32_t> reached = {0};
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const RegionId region{reached[i]};
      const std::vector<RegionId> children = tree.children(region);
      EXPECT_EQ(children.empty(), tree.is_leaf(region));
      EXPECT_LE(children.size(), SeamTree::kChildren);
      for (const RegionId child : children) {
        EXPECT_EQ(tree.parent(child), region);
        EXPECT_TRUE(tree.has_edge(region, child));
        EXPECT_TRUE(tree.has_edge(child, region));
        reached.push_back(value_of(child));
      }
    }
    std::ranges::sort(reached);
    ASSERT_EQ(reached.size(), regions);
    for (std::uint32_t i = 0; i < regions; ++i) EXPECT_EQ(reached[i], i);
  }
  EXPECT_FALSE(SeamTree(20).has_edge(RegionId{9}, RegionId{10})) << "both are children of 1";
  EXPECT_FALSE(SeamTree(20).parent(RegionId{0}));
}

TEST(Nearness, OfFewCoupledRegionsIsThatOfAll) {
  const RegionMap map = RegionMap::columns(9, 16);
  const BlockOwners owners(map, 16, 1);
  EXPECT_EQ(regions_near(map, {0, &owners}, RegionId{4}).size(), 8U);
}

TEST(Nearness, OfManyCoupledRegionsIsThatOfPartnersAndOfTheTree) {
  const RegionMap map = RegionMap::columns(12, 16);
  const BlockOwners owners(map, 16, 1);
  EXPECT_THAT(regions_near(map, {0, &owners}, RegionId{5}), ElementsAre(RegionId{0}, RegionId{4}, RegionId{6}));
  EXPECT_THAT(regions_near(map, {0, &owners}, RegionId{11}), ElementsAre(RegionId{1}, RegionId{10}));
  EXPECT_THAT(regions_near(RegionMap::columns(1, 16), {0, nullptr}, RegionId{0}), IsEmpty());
}

/// The number of regions that a region listens to does not grow with the map, and an order reaches all after a few
/// states.
TEST(Nearness, OfCoupledRegionsDoesNotGrowWithTheMap) {
  for (const std::size_t side : {4UL, 8UL, 20UL}) {
    const RegionMap map = RegionMap::grid(side, side, 16, 16);
    const BlockOwners owners(map, 16, 1);
    const auto near = all_near(map, {0, &owners});
    for (std::uint32_t a = 0; a < map.size(); ++a) {
      EXPECT_LE(near[a].size(), 8 + SeamTree::kChildren + 1);
      for (const RegionId b : near[a]) EXPECT_TRUE(std::ranges::binary_search(near[value_of(b)], RegionId{a}));
    }
    EXPECT_LE(hops_from(RegionId{0}, near), side <= 8 ? 2 : 3);
  }
}

}  // namespace
}  // namespace aurasim::core::testing
