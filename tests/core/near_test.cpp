// The indexes of places, against looking at every point.
#include <algorithm>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "core/covered_columns.h"
#include "core/near_index.h"
#include "core/random.h"
#include "core/spatial_grid.h"

namespace aurasim::core::testing {
namespace {

std::vector<Vec3> random_points(Random& random, std::size_t count, double half_size) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(random.in_box(half_size));
  return points;
}

class AGrid : public ::testing::Test {
 protected:
  void fill(const std::vector<Vec3>& points, double cell_m) {
    grid.clear(cell_m);
    for (std::uint32_t i = 0; i < points.size(); ++i) grid.add(i, points[i]);
    grid.build();
  }
  void expect_all_within(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi) {
    std::map<std::uint32_t, int> visits;
    grid.for_each_in(lo, hi, [&](std::uint32_t i) { ++visits[i]; });
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const bool inside = (points[i].array() >= lo.array()).all() && (points[i].array() <= hi.array()).all();
      ASSERT_LE(visits[i], 1);
      ASSERT_TRUE(!inside || visits[i] == 1) << "point " << i;
    }
  }

  SpatialGrid grid;
};

class Grid : public AGrid, public ::testing::WithParamInterface<double> {};

TEST_P(Grid, VisitsEveryPointInTheBoxOnce) {
  Random random("points");
  for (int run = 0; run < 40; ++run) {
    const std::vector<Vec3> points = random_points(random, 1 + random.below(300), 50);
    fill(points, GetParam());
    for (int query = 0; query < 40; ++query) {
      const Vec3 centre = random.in_box(60);
      const Vec3 half = (random.in_box(random.chance(0.3) ? 60 : 5)).cwiseAbs();
      expect_all_within(points, centre - half, centre + half);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CellSizes, Grid, ::testing::Values(0.01, 0.7, 3.0, 1000.0));

TEST_F(AGrid, HoldsPointsFarOut) {
  Random random("points");
  std::vector<Vec3> points = random_points(random, 100, 1e13);
  points.emplace_back(1e300, -1e300, 0);
  fill(points, 0.5);
  for (const Vec3& p : points) expect_all_within(points, p - Vec3::Ones(), p + Vec3::Ones());
}

TEST_F(AGrid, VisitsOnlyNearCells) {
  Random random("points");
  fill(random_points(random, 2000, 50), 1.0);
  std::size_t visits = 0;
  grid.for_each_in(Vec3(0, 0, 0), Vec3(4, 4, 4), [&](std::uint32_t) { ++visits; });
  EXPECT_LT(visits, 50u);
}

TEST_F(AGrid, CanBeFilledAgain) {
  Random random("points");
  fill(random_points(random, 100, 50), 1.0);
  const std::vector<Vec3> points = random_points(random, 10, 5);
  fill(points, 2.0);
  expect_all_within(points, Vec3::Constant(-60), Vec3::Constant(60));
  fill({}, 2.0);
  EXPECT_TRUE(grid.empty());
  expect_all_within({}, Vec3::Constant(-60), Vec3::Constant(60));
}

TEST(Columns, AreCoveredWhereASphereIs) {
  Random random("spheres");
  int apart = 0;
  for (int run = 0; run < 100; ++run) {
    CoveredColumns columns;
    columns.clear(random.between(0.5, 4));
    std::vector<std::pair<Vec3, double>> spheres;
    for (int i = 0; i < 20; ++i) {
      spheres.emplace_back(random.in_box(100), random.between(0, 2));
      columns.add(spheres.back().first, spheres.back().second);
    }
    for (int query = 0; query < 100; ++query) {
      const Vec3 p = random.in_box(100);
      const double r = random.between(0, 3);
      const bool meets = std::ranges::any_of(
          spheres, [&](const auto& sphere) { return (sphere.first - p).norm() <= sphere.second + r; });
      ASSERT_TRUE(!meets || columns.may_meet(p, r));
      apart += columns.may_meet(p, r) ? 0 : 1;
    }
  }
  EXPECT_GT(apart, 8000) << "most are far from all";
}

TEST(Columns, ASphereThatIsEverywhereMeetsAll) {
  CoveredColumns columns;
  columns.clear(1);
  EXPECT_FALSE(columns.may_meet(Vec3(1e6, 0, 0), 0.5));
  EXPECT_TRUE(columns.may_meet(Vec3::Zero(), 1e6));
  EXPECT_TRUE(columns.may_meet(Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0), 0.5));
  columns.add(Vec3::Zero(), 1e6);
  EXPECT_TRUE(columns.may_meet(Vec3(1e6, 0, 0), 0.5));
}

class Near : public ::testing::Test {
 protected:
  void place(Random& random, std::size_t count) {
    paths.assign(count, {});
    for (Path& path : paths) {
      path.pose.p_WB = random.in_box(40);
      path.radius_m = random.chance(0.05) ? random.between(5, 20) : random.between(0.1, 1);
      path.speed_m_s = random.chance(0.3) ? random.between(3, 30) : random.between(0, 3);
    }
    index.build(paths);
  }
  std::set<std::uint32_t> near(const Vec3& p, double radius, const Range& range) const {
    std::set<std::uint32_t> found;
    const auto range_at = [&](double speed_m_s) { return range.at(speed_m_s); };
    index.for_each_near(p, radius, range_at, [&](std::uint32_t i) { found.insert(i); });
    return found;
  }
  void expect_found(const Vec3& p, double radius, const Range& range) const {
    const std::set<std::uint32_t> found = near(p, radius, range);
    for (std::uint32_t i = 0; i < paths.size(); ++i) {
      const double gap = (paths[i].pose.p_WB - p).norm() - paths[i].radius_m - radius;
      ASSERT_TRUE(gap > range.at(paths[i].speed_m_s) || found.contains(i)) << "body " << i;
    }
  }

  NearIndex index;
  std::vector<Path> paths;
};

TEST_F(Near, FindsEveryBodyInItsRange) {
  Random random("bodies");
  for (int run = 0; run < 100; ++run) {
    place(random, random.below(200));
    for (int query = 0; query < 20; ++query) {
      expect_found(random.in_box(50), random.between(0, 3), {random.between(0, 5), random.between(0, 0.5)});
    }
  }
}

TEST_F(Near, KnowsTheTopSpeedAndRadius) {
  Random random("bodies");
  place(random, 100);
  const auto slower = [](const Path& a, const Path& b) { return a.speed_m_s < b.speed_m_s; };
  EXPECT_EQ(index.top_speed(), std::max_element(paths.begin(), paths.end(), slower)->speed_m_s);
  double radius = 0;
  for (const Path& path : paths) radius = std::max(radius, path.radius_m);
  EXPECT_EQ(index.top_radius(), radius);
  place(random, 0);
  EXPECT_EQ(index.top_speed(), 0);
  EXPECT_EQ(index.top_radius(), 0);
}

TEST_F(Near, OneLargeBodyDoesNotWidenEveryQuery) {
  Random random("bodies");
  place(random, 500);
  for (Path& path : paths) path.radius_m = 0.5;
  paths[7].radius_m = 30;
  index.build(paths);
  EXPECT_LT(near(Vec3::Zero(), 0.5, {1, 0.05}).size(), 60u);
}

}  // namespace
}  // namespace aurasim::core::testing
