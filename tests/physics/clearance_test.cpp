// Distances against closed forms. Bullet works in single precision in one of the two builds.
#include "physics/clearance.h"

#include <cmath>

#include <LinearMath/btScalar.h>
#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

constexpr double kTolerance = sizeof(btScalar) == sizeof(double) ? 1e-6 : 1e-3;
constexpr double kFar = 100;

Quat turned(double angle, const Vec3& axis) { return Quat(Eigen::AngleAxisd(angle, axis)); }

Pose random_pose(std::mt19937_64& random, double far) {
  return {{uniform(random, -far, far), uniform(random, -far, far), uniform(random, -far, far)},
          Quat(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), 0.2).normalized()};
}

class Clearance : public ::testing::Test {
 protected:
  double between(const core::Shape& a, const Pose& pose_a, const core::Shape& b, const Pose& pose_b,
                 double limit = kFar) {
    core::Scene scene = scene_of(a);
    scene.prototypes.push_back(scene.prototypes[0]);
    scene.prototypes[1].shape = static_cast<std::uint32_t>(scene.shapes.size());
    scene.shapes.push_back({"b", b});
    return make_clearance_query(scene)->clearance(core::PrototypeId{0}, pose_a, core::PrototypeId{1}, pose_b, limit);
  }
};

Pose at(double x, double y, double z, const Quat& q = Quat::Identity()) { return {{x, y, z}, q}; }

TEST_F(Clearance, OfSpheresIsTheGapBetweenThem) {
  EXPECT_NEAR(between(core::Sphere{1}, at(0, 0, 0), core::Sphere{0.5}, at(3, 0, 4)), 3.5, kTolerance);
}

TEST_F(Clearance, OfOverlappingSpheresIsNegative) {
  EXPECT_NEAR(between(core::Sphere{1}, at(0, 0, 0), core::Sphere{0.5}, at(1.2, 0, 0)), -0.3, kTolerance);
  EXPECT_NEAR(between(core::Sphere{1}, at(0, 0, 0), core::Sphere{0.5}, at(0.1, 0, 0)), -1.4, 10 * kTolerance);
}

TEST_F(Clearance, OfBoxesFaceToFace) {
  const core::Box cube{{0.5, 0.5, 0.5}};
  EXPECT_NEAR(between(cube, at(0, 0, 0), cube, at(1.3, 0.2, 0.1)), 0.3, kTolerance);
  EXPECT_NEAR(between(cube, at(0, 0, 0), cube, at(0.9, 0.2, 0.1)), -0.1, kTolerance);
}

/// Where Bullet's rounded edges would be 0.03 m farther apart.
TEST_F(Clearance, OfBoxesCornerToCorner) {
  const core::Box cube{{0.5, 0.5, 0.5}};
  EXPECT_NEAR(between(cube, at(0, 0, 0), cube, at(1.3, 1.3, 1.3)), 0.3 * std::sqrt(3), kTolerance);
  EXPECT_NEAR(between(cube, at(0, 0, 0), cube, at(1.3, 1.3, 0)), 0.3 * std::sqrt(2), kTolerance);
}

TEST_F(Clearance, OfATurnedBoxToASphere) {
  const core::Box cube{{0.5, 0.5, 0.5}};
  EXPECT_NEAR(between(cube, at(0, 0, 0, turned(M_PI / 4, Vec3::UnitZ())), core::Sphere{0.25}, at(2, 0, 0)),
              2 - 0.25 - std::sqrt(0.5), kTolerance);
}

TEST_F(Clearance, OfCapsules) {
  const core::Capsule capsule{0.3, 2};
  EXPECT_NEAR(between(capsule, at(0, 0, 0), capsule, at(1, 0, 0)), 0.4, kTolerance) << "side by side";
  EXPECT_NEAR(between(capsule, at(0, 0, 0), capsule, at(0, 0, 3)), 0.4, kTolerance) << "end to end";
  EXPECT_NEAR(between(capsule, at(0, 0, 0), capsule, at(1, 0, 0, turned(M_PI / 2, Vec3::UnitX()))), 0.4, kTolerance)
      << "crossed";
  EXPECT_NEAR(between(capsule, at(0, 0, 0), capsule, at(0.5, 0, 0, turned(1, Vec3::UnitX()))), -0.1, kTolerance);
}

TEST_F(Clearance, OfABoxToACapsule) {
  const core::Box cube{{0.5, 0.5, 0.5}};
  const core::Capsule capsule{0.3, 2};
  const Quat lying = turned(M_PI / 2, Vec3::UnitY());
  EXPECT_NEAR(between(cube, at(0, 0, 0), capsule, at(0.2, 0, 1.2, lying)), 0.4, kTolerance) << "above a face";
  EXPECT_NEAR(between(capsule, at(0, 0.8, 0.8, lying), cube, at(0, 0, 0)), 0.3 * std::sqrt(2) - 0.3, kTolerance)
      << "beside an edge";
  EXPECT_NEAR(between(cube, at(0, 0, 0), capsule, at(1.8, 0.8, 0.8, lying)), 0.3 * std::sqrt(3) - 0.3, kTolerance)
      << "its end beyond a corner";
  EXPECT_NEAR(between(cube, at(0, 0, 0), capsule, at(0, 0, 0.7, lying)), -0.1, kTolerance) << "in the face";
}

TEST_F(Clearance, OfCylinders) {
  const core::Cylinder cylinder{0.3, 2};
  EXPECT_NEAR(between(cylinder, at(0, 0, 0), cylinder, at(1, 0, 0)), 0.4, kTolerance) << "side by side";
  EXPECT_NEAR(between(cylinder, at(0, 0, 0), cylinder, at(0.1, 0, 3)), 1, kTolerance) << "end to end";
  EXPECT_NEAR(between(cylinder, at(0, 0, 0), core::Sphere{0.1}, at(0.6, 0, 1.4)), 0.4, 10 * kTolerance) << "rim";
}

TEST_F(Clearance, OfHulls) {
  core::ConvexHull octahedron;
  for (int i = 0; i < 3; ++i) {
    octahedron.points.push_back(Vec3::Unit(i));
    octahedron.points.push_back(-Vec3::Unit(i));
  }
  EXPECT_NEAR(between(octahedron, at(0, 0, 0), octahedron, at(3, 0, 0)), 1, kTolerance) << "tip to tip";
  const double face = 1 / std::sqrt(3);
  EXPECT_NEAR(between(octahedron, at(0, 0, 0), core::Sphere{0.5}, at(2 * face, 2 * face, 2 * face)), 2 - face - 0.5,
              kTolerance)
      << "face";
}

TEST_F(Clearance, OfACompoundIsThatOfItsNearestPart) {
  core::Compound dumbbell;
  dumbbell.parts.push_back({core::Sphere{0.5}, at(-2, 0, 0)});
  dumbbell.parts.push_back({core::Sphere{0.5}, at(2, 0, 0)});
  EXPECT_NEAR(between(dumbbell, at(0, 0, 0), core::Sphere{0.5}, at(0, 0, 0)), 1, kTolerance) << "in its middle";
  EXPECT_NEAR(between(dumbbell, at(0, 0, 0), core::Sphere{0.5}, at(5, 0, 0)), 2, kTolerance);
  EXPECT_NEAR(between(dumbbell, at(0, 0, 0, turned(M_PI / 2, Vec3::UnitZ())), dumbbell, at(0, 6, 0)),
              std::sqrt(4 + 16) - 1, kTolerance);
}

TEST_F(Clearance, DoesNotChangeWhenBothBodiesAreMovedAndTurned) {
  std::mt19937_64 random(11);
  const core::Scene scene = scene_of_all_shapes();
  const auto query = make_clearance_query(scene);
  for (int i = 0; i < 2000; ++i) {
    const core::PrototypeId a{static_cast<std::uint32_t>(random() % kKinds)};
    const core::PrototypeId b{static_cast<std::uint32_t>(random() % kKinds)};
    const Pose pose_a = random_pose(random, 1.5), pose_b = random_pose(random, 1.5), moved = random_pose(random, 5000);
    const auto move = [&](const Pose& p) { return Pose{moved.p_WB + moved.q_WB * p.p_WB, moved.q_WB * p.q_WB}; };
    const double here = query->clearance(a, pose_a, b, pose_b, kFar);
    const double there = query->clearance(a, move(pose_a), b, move(pose_b), kFar);
    const double swapped = query->clearance(b, pose_b, a, pose_a, kFar);
    const double tolerance = here > 0 ? 10 * kTolerance : 0.01;  // overlaps are found by steps, not exactly
    EXPECT_NEAR(here, there, tolerance) << "kinds " << core::value_of(a) << " and " << core::value_of(b);
    EXPECT_NEAR(here, swapped, tolerance) << "kinds " << core::value_of(a) << " and " << core::value_of(b);
  }
}

TEST_F(Clearance, AboveTheLimitIsAboveTheLimit) {
  const core::Box cube{{0.5, 0.5, 0.5}};
  EXPECT_GT(between(cube, at(0, 0, 0), cube, at(50, 0, 0), 2), 2);
  EXPECT_GT(between(cube, at(0, 0, 0), cube, at(3.001, 0, 0), 2), 2);
  EXPECT_NEAR(between(cube, at(0, 0, 0), cube, at(2.9, 0, 0), 2), 1.9, kTolerance);
}

TEST_F(Clearance, IsWithinALimitWheneverItIs) {
  std::mt19937_64 random(12);
  const core::Scene scene = scene_of_all_shapes();
  const auto query = make_clearance_query(scene);
  int within = 0, beyond = 0;
  for (int i = 0; i < 20'000; ++i) {
    const core::PrototypeId a{static_cast<std::uint32_t>(random() % kKinds)};
    const core::PrototypeId b{static_cast<std::uint32_t>(random() % kKinds)};
    const Pose pose_a = random_pose(random, 1), pose_b = random_pose(random, 1);
    const double exact = query->clearance(a, pose_a, b, pose_b, kFar);
    const double limit = uniform(random, 0, 0.5);
    if (std::abs(exact - limit) < 10 * kTolerance) continue;
    const double answer = query->clearance(a, pose_a, b, pose_b, limit);
    ASSERT_EQ(answer <= limit, exact <= limit) << "kinds " << core::value_of(a) << " and " << core::value_of(b);
    if (answer > limit) {
      ASSERT_LE(answer, exact + 10 * kTolerance);
    } else {
      ASSERT_NEAR(answer, exact, exact > 0 ? kTolerance : 0.01);
    }
    ++(answer <= limit ? within : beyond);
  }
  EXPECT_GT(within, 5000);
  EXPECT_GT(beyond, 5000);
}

TEST_F(Clearance, KnowsBoundingRadii) {
  const core::Scene scene = scene_of_all_shapes();
  const auto query = make_clearance_query(scene);
  EXPECT_DOUBLE_EQ(query->bounding_radius(core::PrototypeId{kSphere}), 0.4);
  EXPECT_DOUBLE_EQ(query->bounding_radius(core::PrototypeId{kCapsule}), 0.6);
}

}  // namespace
}  // namespace aurasim::physics::testing
