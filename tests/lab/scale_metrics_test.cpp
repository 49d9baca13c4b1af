// The arithmetic of the scalability experiment: windows, fits, returns, figures of a run.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "lab/scale/fit.h"
#include "lab/scale/message_sizes.h"
#include "lab/scale/rain.h"
#include "lab/scale/rain_summary.h"
#include "lab/scale/round_trips.h"
#include "lab/scale/window.h"

namespace aurasim::lab {
namespace {

using core::BodyId;
using core::RegionId;

TEST(Fit, FindsTheLineThatThePointsLieOn) {
  const std::vector<double> xs = {1, 2, 4, 8};
  const std::vector<double> ys = {5, 7, 11, 19};
  const Line line = fitted_line(xs, ys);
  EXPECT_NEAR(line.slope, 2, 1e-12);
  EXPECT_NEAR(line.intercept, 3, 1e-12);
}

TEST(Fit, GrowthIsTheSlopeOfTheLogarithm) {
  std::vector<double> xs, ys;
  for (int i = 0; i < 10; ++i) {
    xs.push_back(1000.0 * i);
    ys.push_back(2 * std::pow(10, 0.0002 * xs.back()));
  }
  EXPECT_NEAR(fitted_growth(xs, ys).slope, 0.0002, 1e-12);
}

TEST(Fit, OnePlaceHasNoSlope) {
  const std::vector<double> xs = {3, 3};
  const std::vector<double> ys = {1, 5};
  EXPECT_EQ(fitted_line(xs, ys).slope, 0);
  EXPECT_EQ(fitted_line(xs, ys).intercept, 3);
}

TEST(Fit, MedianOfAnEvenNumberIsBetweenTheMiddleTwo) {
  EXPECT_EQ(median({5, 1, 2, 3}), 2.5);
  EXPECT_EQ(median({5, 1, 2}), 2);
}

TEST(RoundTrips, CountsWhoComesBackInTime) {
  RoundTrips trips(60);
  const RegionId a{0}, b{1}, c{2};
  EXPECT_FALSE(trips.add(BodyId{1}, a, b, 100));
  EXPECT_TRUE(trips.add(BodyId{1}, b, a, 160)) << "back after 60 steps";
  EXPECT_FALSE(trips.add(BodyId{1}, a, b, 221)) << "back again, but 61 steps later";
  EXPECT_FALSE(trips.add(BodyId{1}, b, c, 222)) << "on its way";
  EXPECT_FALSE(trips.add(BodyId{2}, b, a, 222)) << "another body";
  EXPECT_EQ(trips.moves(), 5U);
  EXPECT_EQ(trips.returns(), 1U);
}

StepLoad load(double physics_ms, std::size_t bodies) {
  StepLoad load;
  load.physics_ms = physics_ms;
  load.protocol_ms = 1;
  load.bodies = bodies;
  load.departures = 2;
  load.largest_cluster = bodies / 2;
  return load;
}

/// Two nodes that take turns in being slow.
WindowSums two_nodes() {
  WindowSums sums(2, 10);
  for (core::Step step = 1; step <= 25; ++step) {
    sums.add(0, step, load(step % 2 == 0 ? 9 : 3, 10));
    sums.add(1, step, load(step % 2 == 0 ? 3 : 9, 20));
  }
  return sums;
}

TEST(Windows, TheSlowestNodeOfEachStepIsTheFrame) {
  const std::vector<Window> windows = two_nodes().windows();
  ASSERT_EQ(windows.size(), 2U) << "two whole windows";
  EXPECT_DOUBLE_EQ(windows[0].frame_mean_ms, 10);
  EXPECT_DOUBLE_EQ(windows[0].frame_max_ms, 10);
  EXPECT_NEAR(windows[0].physics_ms, 12, 1e-12) << "of both nodes";
  EXPECT_EQ(windows[0].bodies, 30U);
  EXPECT_EQ(windows[0].most_hosted, 20U);
  EXPECT_EQ(windows[0].departures, 40U);
  EXPECT_EQ(windows[0].largest_cluster, 10U);
}

TEST(RainFigures, AddUpAndCompare) {
  const RainFigures f = figures_of(two_nodes().windows(), 2);
  EXPECT_DOUBLE_EQ(f.frame_max_ms, 10);
  EXPECT_EQ(f.departures, 80U);
  EXPECT_NEAR(f.last.physics_ms, 12, 1e-12) << "of both nodes";
  EXPECT_NEAR(f.overhead_share, 2.0 / 12, 1e-12);
  EXPECT_DOUBLE_EQ(f.most_hosted_share, 2 * 20.0 / 30);
}

TEST(MessageSizes, AurasKeepToTheirBounds) {
  std::map<std::string, double> sizes;
  for (const ResultRow& row : message_sizes()) sizes[row.what] = row.value;
  EXPECT_LE(sizes.at("size/each aura update, tight"), 40);
  EXPECT_LE(sizes.at("size/each aura update, swept"), 80);
  EXPECT_GT(sizes.at("size/each aura update, tight"), 8) << "an id alone";
}

TEST(Rain, EveryRunHasANameOfItsOwn) {
  Rain a;
  a.series = "columns";
  Rain b = a;
  b.uncertainty = 0.25;
  EXPECT_NE(a.name(), b.name());
}

}  // namespace
}  // namespace aurasim::lab
