#include "core/region_map.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random.h"
#include "core/vicinity.h"

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

RegionId r(std::uint32_t id) { return RegionId{id}; }

struct NamedMap {
  std::string name;
  RegionMap map;
};

/// A pinwheel: five boxes around each other that no line cuts through.
RegionMap pinwheel() {
  return RegionMap::boxes({{0, 0, 2, 1}, {2, 0, 3, 2}, {1, 2, 3, 3}, {0, 1, 1, 3}, {1, 1, 2, 2}});
}

std::vector<NamedMap> all_maps() {
  return {{"One", RegionMap::columns(1, 10)},
          {"Columns", RegionMap::columns(5, 3)},
          {"Grid", RegionMap::grid(3, 4, 2, 5)},
          {"Row", RegionMap::grid(1, 3, 2, 5)},
          {"Brick", RegionMap::brick(4, 3, 2, 1.5)},
          {"NarrowBrick", RegionMap::brick(3, 1, 2, 1.5)},
          {"Pinwheel", pinwheel()},
          {"Boxes", RegionMap::boxes({{-1, -1, 0, 1}, {0, -1, 2, 0}, {0, 0, 2, 1}})}};
}

class AnyRegionMap : public ::testing::TestWithParam<NamedMap> {
 protected:
  const RegionMap& map() const { return GetParam().map; }

  void expect_one_owner(double x, double y) const {
    int owners = 0;
    for (std::uint32_t i = 0; i < map().size(); ++i) owners += map().region(r(i)).contains(x, y);
    ASSERT_EQ(owners, 1) << "at " << x << ", " << y;
    ASSERT_TRUE(map().region(map().owner(x, y)).contains(x, y)) << "at " << x << ", " << y;
  }

  /// Every edge of every region, the floating-point numbers next to it, and places far out.
  std::vector<double> sample_places(double Rectangle::*low, double Rectangle::*high) const {
    std::vector<double> places = {-1e300, -1e9, 0, -0.0, 1e9, 1e300};
    for (std::uint32_t i = 0; i < map().size(); ++i) {
      for (const double edge : {map().region(r(i)).*low, map().region(r(i)).*high}) {
        if (!std::isfinite(edge)) continue;
        places.insert(places.end(), {edge, std::nextafter(edge, -kInfinity), std::nextafter(edge, kInfinity)});
      }
    }
    return places;
  }
};

TEST_P(AnyRegionMap, EveryRandomPointHasExactlyOneOwner) {
  Random random("points");
  for (int i = 0; i < 20000; ++i) expect_one_owner(random.between(-12, 12), random.between(-12, 12));
}

TEST_P(AnyRegionMap, PointsOnEdgesAndCornersAndFarOutHaveExactlyOneOwner) {
  for (const double x : sample_places(&Rectangle::x0, &Rectangle::x1)) {
    for (const double y : sample_places(&Rectangle::y0, &Rectangle::y1)) expect_one_owner(x, y);
  }
}

TEST_P(AnyRegionMap, DistanceIsZeroExactlyToRegionsThatThePointIsInOrOn) {
  Random random("points");
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = random.in_box(12);
    for (std::uint32_t j = 0; j < map().size(); ++j) {
      ASSERT_EQ(map().distance(r(j), p) == 0, map().owner(p) == r(j));
    }
  }
}

TEST_P(AnyRegionMap, NeighboursAreMutual) {
  for (std::uint32_t i = 0; i < map().size(); ++i) {
    for (const RegionId other : map().neighbours(r(i), 1.0)) {
      EXPECT_THAT(map().neighbours(other, 1.0), ::testing::Contains(r(i)));
    }
  }
}

TEST_P(AnyRegionMap, RegionsThatShareAPointAreNeighbours) {
  for (const double x : sample_places(&Rectangle::x0, &Rectangle::x1)) {
    for (const double y : sample_places(&Rectangle::y0, &Rectangle::y1)) {
      std::vector<RegionId> meeting;
      for (std::uint32_t i = 0; i < map().size(); ++i) {
        if (map().region(r(i)).distance(x, y) == 0) meeting.push_back(r(i));
      }
      for (const RegionId a : meeting) {
        for (const RegionId b : meeting) {
          if (a == b) continue;
          ASSERT_THAT(map().neighbours(a), ::testing::Contains(b));
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, AnyRegionMap, ::testing::ValuesIn(all_maps()),
                         [](const auto& info) { return info.param.name; });

TEST(RegionMap, APointOnABoundaryBelongsToTheHigherSide) {
  const RegionMap map = RegionMap::grid(2, 2, 10, 10);
  EXPECT_EQ(map.owner(0, -1), r(1));
  EXPECT_EQ(map.owner(-1, 0), r(2));
  EXPECT_EQ(map.owner(0, 0), r(3));
}

TEST(RegionMap, OutermostRegionsReachToInfinity) {
  const RegionMap map = RegionMap::grid(3, 3, 10, 10);
  EXPECT_EQ(map.region(r(0)).x0, -kInfinity);
  EXPECT_EQ(map.region(r(0)).y0, -kInfinity);
  EXPECT_EQ(map.region(r(8)).x1, kInfinity);
  EXPECT_EQ(map.region(r(8)).y1, kInfinity);
  EXPECT_EQ(map.owner(1e200, 0), r(5));
  EXPECT_EQ(map.owner(-1e200, 1e200), r(6));
  EXPECT_EQ(map.region(r(4)).x0, -5);
  EXPECT_EQ(map.region(r(4)).y1, 5);
}

TEST(RegionMap, ColumnsStandSideBySideAroundTheOrigin) {
  const RegionMap map = RegionMap::columns(4, 40);
  EXPECT_EQ(map.owner(-41, 5), r(0));
  EXPECT_EQ(map.owner(-39, 5), r(1));
  EXPECT_EQ(map.owner(39, -1e6), r(2));
  EXPECT_EQ(map.owner(41, 1e6), r(3));
  EXPECT_EQ(map.narrowest_m(), 40);
}

TEST(RegionMap, ColumnsHaveNeighboursByEdgeOnly) {
  const RegionMap map = RegionMap::columns(4, 40);
  EXPECT_THAT(map.neighbours(r(0)), ElementsAre(r(1)));
  EXPECT_THAT(map.neighbours(r(1)), ElementsAre(r(0), r(2)));
  EXPECT_THAT(map.neighbours(r(0), 39.9), ElementsAre(r(1)));
  EXPECT_THAT(map.neighbours(r(0), 40), ElementsAre(r(1), r(2)));
}

TEST(RegionMap, ACellOfAGridHasNeighboursByEdgeAndByCorner) {
  const RegionMap map = RegionMap::grid(3, 3, 10, 10);
  EXPECT_THAT(map.neighbours(r(4)), ElementsAre(r(0), r(1), r(2), r(3), r(5), r(6), r(7), r(8)));
  EXPECT_THAT(map.neighbours(r(0)), ElementsAre(r(1), r(3), r(4)));
}

TEST(RegionMap, ThreeBricksMeetAtACornerAndNeverFour) {
  const RegionMap map = RegionMap::brick(4, 4, 10, 5);
  for (const double x : {-10.0, -5.0, 0.0, 5.0, 10.0}) {
    for (const double y : {-5.0, 0.0, 5.0}) {
      int meeting = 0;
      for (std::uint32_t i = 0; i < map.size(); ++i) meeting += map.region(r(i)).distance(x, y) == 0;
      EXPECT_EQ(meeting, 3) << "at " << x << ", " << y;
    }
  }
}

TEST(RegionMap, ABrickInsideTheWallHasSixNeighbours) {
  const RegionMap map = RegionMap::brick(4, 4, 10, 5);
  EXPECT_THAT(map.neighbours(r(5)), ElementsAre(r(1), r(2), r(4), r(6), r(9), r(10)));
}

TEST(RegionMap, DistanceIsStraightToEdgesAndCorners) {
  const RegionMap map = RegionMap::grid(3, 3, 10, 10);
  EXPECT_EQ(map.distance(r(4), Vec3(0, 0, 99)), 0);
  EXPECT_EQ(map.distance(r(4), Vec3(8, 0, 99)), 3);
  EXPECT_EQ(map.distance(r(4), Vec3(8, -9, 0)), 5);
  EXPECT_EQ(map.distance(r(3), Vec3(-1e9, 6, 0)), 1);
  EXPECT_EQ(map.region(r(0)).distance(map.region(r(8))), std::hypot(10, 10));
  EXPECT_EQ(map.region(r(0)).distance(map.region(r(4))), 0);
}

TEST(RegionMap, OneRegionHasNoNeighbourAndNoNarrowestSide) {
  const RegionMap map = RegionMap::columns(1, 40);
  EXPECT_TRUE(map.neighbours(r(0), 1e9).empty());
  EXPECT_EQ(map.narrowest_m(), kInfinity);
  EXPECT_EQ(map.owner(1e9, -1e9), r(0));
}

void expect_refused(const std::vector<Rectangle>& boxes, const char* why) {
  try {
    (void)RegionMap::boxes(boxes);
    ADD_FAILURE() << "not refused: " << why;
  } catch (const BadRegionMap& error) {
    EXPECT_THAT(error.what(), HasSubstr(why));
  }
}

TEST(RegionMap, RefusesBoxesThatOverlapOrAreEmptyOrLeaveAGap) {
  expect_refused({}, "no box");
  expect_refused({{0, 0, 2, 1}, {1, 0, 3, 1}}, "overlap");
  expect_refused({{0, 0, 2, 1}, {0, 0, 2, 1}}, "overlap");
  expect_refused({{0, 0, 3, 3}, {1, 1, 2, 2}}, "overlap");
  expect_refused({{0, 0, 1, 1}, {2, 0, 3, 1}}, "gap");
  expect_refused({{0, 0, 1, 1}, {1, 1, 2, 2}}, "gap");
  expect_refused({{0, 0, 2, 1}, {2, 0, 3, 2}, {1, 2, 3, 3}, {0, 1, 1, 3}}, "gap");
  expect_refused({{0, 0, 0, 1}}, "empty");
  expect_refused({{0, 1, 1, 0}}, "empty");
  expect_refused({{0, 0, kInfinity, 1}}, "empty");
  expect_refused({{0, 0, std::nan(""), 1}}, "empty");
}

TEST(RegionMap, NamesTheBoxesThatOverlap) {
  expect_refused({{0, 0, 1, 1}, {1, 0, 3, 1}, {2, 0, 4, 1}}, "boxes 1 [1.000000");
}

TEST(RegionMap, RefusesLayoutsWithoutRegionsOrSize) {
  EXPECT_THROW((void)RegionMap::columns(0, 1), BadRegionMap);
  EXPECT_THROW((void)RegionMap::columns(2, 0), BadRegionMap);
  EXPECT_THROW((void)RegionMap::columns(2, std::nan("")), BadRegionMap);
  EXPECT_THROW((void)RegionMap::grid(0, 1, 1, 1), BadRegionMap);
  EXPECT_THROW((void)RegionMap::grid(1, 1, -1, 1), BadRegionMap);
  EXPECT_THROW((void)RegionMap::brick(2, 0, 1, 1), BadRegionMap);
}

TEST(RegionMap, VersionsAreEqualForEqualMapsAndNothingElse) {
  std::set<std::uint64_t> versions;
  std::size_t maps = 0;
  for (std::size_t n = 1; n < 6; ++n) {
    for (const double size : {3.0, 3.0000000001, 40.0}) {
      for (const RegionMap& map : {RegionMap::grid(n, 3, size, 2 * size), RegionMap::grid(3, n + 3, size, size),
                                   RegionMap::brick(n + 1, 3, size, 2 * size)}) {
        versions.insert(map.version());
        ++maps;
      }
    }
  }
  EXPECT_EQ(versions.size(), maps);
  EXPECT_EQ(RegionMap::grid(2, 2, 3, 4).version(), RegionMap::grid(2, 2, 3, 4).version());
}

TEST(RegionMap, TheSameRegionsHaveTheSameVersionHoweverTheyWereWritten) {
  const RegionMap boxes = RegionMap::boxes({{-10, -3, 0, 7}, {0, -3, 10, 7}});
  EXPECT_EQ(boxes.version(), RegionMap::columns(2, 10).version());
}

TEST(RegionMap, SwappedIdsMakeAnotherMap) {
  const RegionMap a = RegionMap::boxes({{0, 0, 1, 1}, {1, 0, 2, 1}});
  const RegionMap b = RegionMap::boxes({{1, 0, 2, 1}, {0, 0, 1, 1}});
  EXPECT_NE(a.version(), b.version());
}

TEST(Vicinity, NamesTheNeighboursInReachOfAPoint) {
  const RegionMap map = RegionMap::grid(2, 2, 10, 10);
  const Vicinity vicinity(map, r(1), 0);
  EXPECT_THAT(vicinity.neighbours, ElementsAre(r(0), r(2), r(3)));
  const Vec3 p(1, -3, 0);
  EXPECT_EQ(vicinity.within(p, 0.9), 0u);
  EXPECT_EQ(vicinity.within(p, 1), vicinity.bit_of(r(0)));
  EXPECT_EQ(vicinity.within(p, 3), vicinity.bit_of(r(0)) | vicinity.bit_of(r(3)));
  EXPECT_EQ(vicinity.within(p, 3.2), vicinity.bit_of(r(0)) | vicinity.bit_of(r(3)) | vicinity.bit_of(r(2)));
  EXPECT_TRUE(vicinity.deep_inside(p, 0.9));
  EXPECT_FALSE(vicinity.deep_inside(p, 1));
  EXPECT_EQ(vicinity.bit_of(r(1)), 0u);
}

TEST(Vicinity, ListensOnlyToRegionsWithinTheNeighbourDistance) {
  const RegionMap map = RegionMap::columns(4, 10);
  const Vicinity vicinity(map, r(0), 0);
  EXPECT_TRUE(vicinity.is_neighbour(r(1)));
  EXPECT_FALSE(vicinity.is_neighbour(r(2)));
  EXPECT_EQ(vicinity.bit_of(r(2)), 0u);
}

TEST(Vicinity, GrowsByRegionsThatAreFarAway) {
  const RegionMap map = RegionMap::columns(100, 1);
  Vicinity vicinity(map, r(50), 0);
  vicinity.listen_to(r(3));
  vicinity.listen_to(r(3));
  EXPECT_THAT(vicinity.neighbours, ElementsAre(r(3), r(49), r(51)));
  EXPECT_TRUE(vicinity.is_neighbour(r(3)));
  EXPECT_FALSE(vicinity.are_near(r(50), r(3)));
}

}  // namespace
}  // namespace aurasim::core::testing
