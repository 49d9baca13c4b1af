// The hard cases in short: on a border the bits are those of one node, and what is measured can tell right from wrong.
#include "lab/stability/stability.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lab/pareto.h"
#include "physics/solver_names.h"

namespace aurasim::lab {
namespace {

class HardCase : public testing::TestWithParam<Case> {};

/// Cut short where there are many bodies.
TEST_P(HardCase, HasTheSameBitsAndErrorsOnABorderBetweenTwoNodes) {
  Case c = GetParam();
  c.duration_s = std::min(c.duration_s, c.scene.bodies.size() > 100 ? 0.5 : 1.5);
  const StabilityRow row = run_stability(c, RunRules{});
  EXPECT_EQ(row.first_difference(), -1);
  EXPECT_TRUE(row.same_bits());
  EXPECT_EQ(row.one.errors, row.two.errors);
  EXPECT_NE(row.one.hash.back(), 0u);
  for (const double error : row.one.errors) EXPECT_TRUE(std::isfinite(error));
}

INSTANTIATE_TEST_SUITE_P(Stability, HardCase, testing::ValuesIn(stability_cases()), [](const auto& param) {
  std::string name = param.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

MeasuredRun on_one_node(const char* name, int step_hz, double duration_s, RunRules rules = {}) {
  Case c = stability_case(name);
  c.duration_s = duration_s;
  rules.step_hz = step_hz;
  return run_case(c, rules, one_node());
}

TEST(StabilityCases, ASmallerStepFallsCloserToTheParabola) {
  const double coarse = on_one_node("free_fall", 60, 1).errors[0];
  const double fine = on_one_node("free_fall", 240, 1).errors[0];
  EXPECT_NEAR(coarse, 0.5 * 9.81 / 60, 1e-3) << "g t dt / 2, semi-implicit Euler";
  EXPECT_NEAR(fine, coarse / 4, 1e-3);
}

TEST(StabilityCases, TheTumblingBoxAndTheElasticBallMeetTheirBounds) {
  const MeasuredRun box = on_one_node("dzhanibekov", 60, 10);
  EXPECT_LT(box.errors[0], 1e-3);
  EXPECT_LT(box.errors[1], 1e-2);
  EXPECT_LT(on_one_node("bouncing_ball_1", 240, 20).errors[0], 0.01);
}

TEST(StabilityCases, APlateRollsOnBallsWithoutErrorOnceFrictionHasTwoDirections) {
  RunRules rules;
  rules.iterations = 50;
  EXPECT_GT(on_one_node("rolling_plate_no_erp", 60, 1, rules).errors[0], 1e-9);
  rules.friction_directions = 2;
  EXPECT_LT(on_one_node("rolling_plate_no_erp", 60, 1, rules).errors[0], 1e-27);
}

TEST(StabilityCases, ACardHouseStandsWithTwoDirectionsOfFriction) {
  EXPECT_EQ(on_one_node("card_house", 60, 4, preset_rules("balanced")).errors[1], 0);
  EXPECT_GT(on_one_node("card_house", 60, 4).errors[1], 0) << "Bullet's own settings";
}

TEST(StabilityCases, ContinuousDetectionStopsTheBulletThatWouldGetThrough) {
  EXPECT_GT(on_one_node("bullet_ccd_off", 60, 0.1).errors[0], 1);
  EXPECT_LT(on_one_node("bullet_ccd_on", 60, 0.1).errors[0], 0.02);
}

TEST(StabilityCases, TheDoublePendulumComesNearerToItsReferenceWithSmallerSteps) {
  const double coarse = on_one_node("double_pendulum", 60, 1).errors[0];
  const double fine = on_one_node("double_pendulum", 1000, 1).errors[0];
  EXPECT_LT(fine, 0.2 * coarse);
  EXPECT_LT(fine, 0.05);
}

TEST(Pareto, TheFrontIsWhatNothingElseBeats) {
  std::vector<ParetoPoint> points(5);
  const auto set = [&](std::size_t i, double error, double cost, int nodes = 1) {
    points[i].error = error, points[i].cpu_us_per_step = cost, points[i].nodes = nodes;
  };
  set(0, 1, 10), set(1, 0.5, 20), set(2, 0.6, 30), set(3, 0.1, 1, 2);
  set(4, 0.5, 19);
  points[4].rules.sync = core::SyncMode::kBounded;
  mark_front(points);
  EXPECT_TRUE(points[0].on_front);
  EXPECT_TRUE(points[1].on_front);
  EXPECT_FALSE(points[2].on_front) << "dearer and worse than the one before";
  EXPECT_FALSE(points[3].on_front) << "on two nodes";
  EXPECT_FALSE(points[4].on_front) << "the same physics in another sync mode";
}

}  // namespace
}  // namespace aurasim::lab
