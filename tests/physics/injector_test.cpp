#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/scene.h"

namespace aurasim::core {
namespace {

constexpr double kStep = 1.0 / 60;

Injector rain() {
  Injector injector;
  injector.seed = 42;
  injector.first_id = BodyId{1000};
  injector.max_bodies = 500;
  injector.rate_per_s = 37;
  injector.volume_min = {-10, -5, 20};
  injector.volume_max = {10, 5, 30};
  injector.velocity_min = {-1, -2, -3};
  injector.velocity_max = {1, 2, 0};
  injector.random_orientation = true;
  injector.prototypes = {PrototypeId{2}, PrototypeId{5}};
  return injector;
}

bool same(const BodyRecord& a, const BodyRecord& b) {
  return a.id == b.id && a.prototype == b.prototype && a.birth == b.birth && a.p_WB == b.p_WB && a.R_WB == b.R_WB &&
         a.v_WB == b.v_WB;
}

TEST(Injector, GivesTheSameBodiesToEveryNode) {
  for (const std::uint64_t index : {0, 1, 7, 499}) {
    EXPECT_TRUE(same(*injected_body(rain(), index, kStep), *injected_body(rain(), index, kStep)));
  }
}

/// On every machine, too: these numbers were worked out by hand-written code that follows the C++ standard.
TEST(Injector, DrawsTheseNumbers) {
  const BodyRecord body = *injected_body(rain(), 3, kStep);
  EXPECT_EQ(body.id, BodyId{1003});
  EXPECT_EQ(body.birth, 7);  // 4/37 s are 6.49 steps
  EXPECT_EQ(body.prototype, PrototypeId{5});
  EXPECT_NEAR(body.p_WB.x(), 2.3555756808726951, 1e-12);
  EXPECT_NEAR(body.v_WB.z(), -2.8279283055171573, 1e-12);
}

TEST(Injector, DrawsOtherNumbersForOtherSeedsAndIndices) {
  Injector other = rain();
  other.seed = 43;
  EXPECT_NE(injected_body(rain(), 0, kStep)->p_WB, injected_body(other, 0, kStep)->p_WB);
  EXPECT_NE(injected_body(rain(), 0, kStep)->p_WB, injected_body(rain(), 1, kStep)->p_WB);
}

TEST(Injector, StaysWithinItsRanges) {
  int of_first_kind = 0;
  Vec3 mean = Vec3::Zero();
  for (std::uint64_t i = 0; i < 500; ++i) {
    const BodyRecord body = *injected_body(rain(), i, kStep);
    EXPECT_TRUE((body.p_WB.array() >= rain().volume_min.array()).all());
    EXPECT_TRUE((body.p_WB.array() < rain().volume_max.array()).all());
    EXPECT_TRUE((body.v_WB.array() >= rain().velocity_min.array()).all());
    EXPECT_TRUE((body.v_WB.array() < rain().velocity_max.array()).all());
    EXPECT_NEAR((body.R_WB * body.R_WB.transpose() - Mat3::Identity()).norm(), 0, 1e-12);
    EXPECT_NEAR(body.R_WB.determinant(), 1, 1e-12);
    of_first_kind += body.prototype == PrototypeId{2};
    mean += body.R_WB.col(2) / 500;
  }
  EXPECT_NEAR(of_first_kind, 250, 60);
  EXPECT_LT(mean.norm(), 0.15) << "orientations are not spread over all directions";
}

TEST(Injector, UprightBodiesStayUpright) {
  Injector injector = rain();
  injector.random_orientation = false;
  EXPECT_EQ(injected_body(injector, 0, kStep)->R_WB, Mat3(Mat3::Identity()));
}

TEST(Injector, EndsAfterItsLastBody) {
  EXPECT_TRUE(injected_body(rain(), 499, kStep));
  EXPECT_FALSE(injected_body(rain(), 500, kStep));
  EXPECT_EQ(injected_count(rain(), 1'000'000, kStep), 500u);
}

TEST(Injector, WithoutBodiesRateOrPrototypesIsEmpty) {
  Injector none = rain(), never = rain(), nothing = rain();
  none.max_bodies = 0;
  never.rate_per_s = 0;
  nothing.prototypes.clear();
  for (const Injector& injector : {none, never, nothing}) {
    EXPECT_FALSE(injected_body(injector, 0, kStep));
    EXPECT_EQ(injected_count(injector, 1000, kStep), 0u);
  }
}

/// 1/60 s is no binary number: 60 per second must still be one body in each step, not none and then two.
TEST(Injector, BirthsThatFallOnAStepAreBornInIt) {
  Injector injector = rain();
  injector.max_bodies = 100'000;
  for (const double rate : {60.0, 30.0, 120.0, 20.0}) {
    injector.rate_per_s = rate;
    for (std::uint64_t i = 0; i < 10'000; ++i) {
      const auto exact = static_cast<Step>(std::ceil(60 * (i + 1) / rate));
      ASSERT_EQ(injected_body(injector, i, kStep)->birth, exact) << "body " << i << " at " << rate << " per second";
    }
  }
}

class InjectorRates : public ::testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(InjectorRates, CountAndBodiesAgree) {
  Injector injector = rain();
  injector.max_bodies = 3000;
  injector.rate_per_s = std::get<0>(GetParam());
  injector.start_s = std::get<1>(GetParam());
  Step last = 0;
  for (std::uint64_t i = 0; i < injector.max_bodies; ++i) {
    const Step birth = injected_body(injector, i, kStep)->birth;
    ASSERT_GE(birth, std::max<Step>(1, last));
    ASSERT_GT(injected_count(injector, birth, kStep), i);
    ASSERT_LE(injected_count(injector, birth - 1, kStep), i);
    last = birth;
  }
}

INSTANTIATE_TEST_SUITE_P(RatesAndStarts, InjectorRates,
                         ::testing::Combine(::testing::Values(0.3, 1.0, 7.0, 59.94, 60.0, 100.0, 1e6),
                                            ::testing::Values(-1.0, 0.0, 0.1, 12.3)));

TEST(InitialRecord, IsTheBodyAsWritten) {
  InitialBody body;
  body.id = BodyId{4};
  body.prototype = PrototypeId{2};
  body.pose.p_WB = {1, 2, 3};
  body.pose.q_WB = Quat(2, 0, 0, 0);  // any length
  body.v_WB = {4, 5, 6};
  body.w_WB = {7, 8, 9};
  const BodyRecord record = initial_record(body);
  EXPECT_EQ(record.id, body.id);
  EXPECT_EQ(record.prototype, body.prototype);
  EXPECT_EQ(record.epoch, 0u);
  EXPECT_EQ(record.birth, 0);
  EXPECT_EQ(record.p_WB, body.pose.p_WB);
  EXPECT_EQ(record.R_WB, Mat3(Mat3::Identity()));
  EXPECT_EQ(record.v_WB, body.v_WB);
  EXPECT_EQ(record.w_WB, body.w_WB);
}

TEST(BoundingRadius, IsThatOfTheSmallestSphereAroundTheOrigin) {
  EXPECT_DOUBLE_EQ(bounding_radius(Sphere{2}), 2);
  EXPECT_DOUBLE_EQ(bounding_radius(Box{{1, 2, 2}}), 3);
  EXPECT_DOUBLE_EQ(bounding_radius(Capsule{0.5, 3}), 2);
  EXPECT_DOUBLE_EQ(bounding_radius(Cylinder{3, 8}), 5);
  EXPECT_DOUBLE_EQ(bounding_radius(ConvexHull{{{0, 3, 4}, {1, 0, 0}}}), 5);
  EXPECT_EQ(bounding_radius(Plane{}), std::numeric_limits<double>::infinity());
}

TEST(BoundingRadius, OfACompoundCountsTheFarthestPointOfItsParts) {
  const Quat quarter(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()));  // z becomes x
  const auto of_part = [&](const ConvexShape& shape, const Vec3& p, const Quat& q) {
    return bounding_radius(Compound{{CompoundPart{shape, {p, q}}}});
  };
  EXPECT_DOUBLE_EQ(of_part(Sphere{1}, {3, 0, 4}, quarter), 6);
  EXPECT_DOUBLE_EQ(of_part(Box{{1, 1, 1}}, {2, 1, 1}, Quat::Identity()), std::sqrt(17.0));
  EXPECT_NEAR(of_part(Capsule{1, 4}, {3, 0, 0}, quarter), 6, 1e-12);
  EXPECT_NEAR(of_part(Cylinder{1, 4}, {1, 2, 0}, quarter), std::sqrt(18.0), 1e-12);
}

}  // namespace
}  // namespace aurasim::core
