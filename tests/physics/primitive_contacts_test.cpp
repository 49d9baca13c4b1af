// Contacts of balls and capsules against slow searches, and what they promise to the step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "physics/bullet_convert.h"
#include "physics/plane_points.h"
#include "physics/rod_points.h"
#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

constexpr double kMargin = 0.02;
/// Points whose gaps differ by less may be chosen for each other.
constexpr double kEqual = kMargin / 40;

btVector3 vector(const Vec3& v) { return to_bullet(v); }

Vec3 random_vector(std::mt19937_64& random, double half) {
  const double x = uniform(random, -half, half), y = uniform(random, -half, half);
  return {x, y, uniform(random, -half, half)};
}

std::span<const RodPoint> all(const RodPoints& found) {
  return std::span(found.points).first(static_cast<std::size_t>(found.count));
}

double deepest(const RodPoints& found) {
  double gap = std::numeric_limits<double>::infinity();
  for (const RodPoint& point : all(found)) gap = std::min(gap, double{point.gap});
  return gap;
}

/// The least value of a convex function of shares of a half length, by trying many, and then many around the best.
template <class Function>
double least(const Function& of) {
  double middle = 0, half = 1, best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 8; ++round) {
    double at = middle;
    for (int i = -20; i <= 20; ++i) {
      const double t = std::clamp(middle + half * i / 20, -1.0, 1.0);
      if (of(t) < best) best = of(t), at = t;
    }
    middle = at, half /= 8;
  }
  return best;
}

/// A ball, or a rod of a random length, sometimes along an axis or hardly turned away from one.
Rod random_rod(std::mt19937_64& random, int form) {
  Rod rod;
  rod.radius = uniform(random, 0.02, 0.4);
  Vec3 along = random_vector(random, 1).normalized();
  if (form % 4 == 1) along = Vec3::Unit(static_cast<int>(random() % 3));
  if (form % 4 == 2) {
    along = (Vec3::Unit(static_cast<int>(random() % 3)) + random_vector(random, std::pow(10, uniform(random, -12, -1))))
                .normalized();
  }
  rod.half = form % 5 == 0 ? btVector3(0, 0, 0) : vector(along * uniform(random, 0.05, 1));
  return rod;
}

/// Moves a rod along `way` until `gap(rod)` is nearly `wanted`. Rods far away along `way` have to be apart.
template <class Gap>
void move_to(Rod& rod, const Vec3& way, double wanted, const Gap& gap) {
  double near = 0, far = 5;
  for (int i = 0; i < 60; ++i) {
    const double middle = (near + far) / 2;
    rod.centre = vector(way * middle);
    (gap(rod) < wanted ? near : far) = middle;
  }
  rod.centre = vector(way * far);
}

double distance_from_segment(const btVector3& p, const Rod& rod) {
  const double length2 = rod.half.length2();
  const double t = length2 > 0 ? rod.half.dot(p - rod.centre) / length2 : 0;
  return (p - rod.at(std::clamp(t, -1.0, 1.0))).length();
}

double gap_between(const Rod& rod, const Rod& other) {
  return least([&](double t) { return distance_from_segment(rod.at(t), other); }) - rod.radius - other.radius;
}

double outside_of_box(const Vec3& p, const Vec3& half_extents) {
  return (p.cwiseAbs() - half_extents).cwiseMax(0).norm();
}

double gap_to_box(const Rod& rod, const Vec3& half_extents) {
  return least([&](double t) { return outside_of_box(from_bullet(rod.at(t)), half_extents); }) - rod.radius;
}

TEST(PrimitiveContacts, RodsAreAsFarApartAsASlowSearchFinds) {
  std::mt19937_64 random(41);
  int touching = 0, apart = 0, two = 0;
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    Rod rod = random_rod(random, i), other = random_rod(random, i / 5);
    const Vec3 place = random_vector(random, 10);
    const double wanted = uniform(random, -0.8 * (rod.radius + other.radius), 0.04);
    move_to(rod, random_vector(random, 1).normalized(), wanted, [&](const Rod& r) { return gap_between(r, other); });
    const double gap = gap_between(rod, other);
    rod.centre += vector(place), other.centre += vector(place);
    const RodPoints found = rod_points(rod, other, kMargin);
    if (found.count == 0) {
      ASSERT_GT(gap, kMargin - 1e-6);
      ++apart;
      continue;
    }
    ++touching, two += found.count == 2;
    ASSERT_NEAR(deepest(found), gap, kEqual + 1e-6);
    ASSERT_GE(deepest(found), gap - 1e-6);
    for (const RodPoint& point : all(found)) {
      ASSERT_NEAR(from_bullet(point.normal).norm(), 1, 1e-9);
      ASSERT_LE(point.gap, kMargin);
      const btVector3 on_rod = point.on_other + point.normal * point.gap;
      ASSERT_LT(distance_from_segment(point.on_other, other), other.radius + 1e-6);
      ASSERT_LT(distance_from_segment(on_rod, rod), rod.radius + 1e-6);
      if (point.gap > deepest(found)) continue;  // a ball of the rod may have its point within another ball of it
      ASSERT_NEAR(distance_from_segment(point.on_other, other), other.radius, kEqual);
      ASSERT_NEAR(distance_from_segment(on_rod, rod), rod.radius, kEqual);
    }
  }
  EXPECT_GT(touching, 2000);
  EXPECT_GT(apart, 80);
  EXPECT_GT(two, 50);
}

TEST(PrimitiveContacts, TheOtherWayRoundRodsHaveTheSameNearestPoint) {
  std::mt19937_64 random(42);
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    Rod rod = random_rod(random, i), other = random_rod(random, i / 5);
    move_to(rod, random_vector(random, 1).normalized(), uniform(random, -0.5 * rod.radius, 0.015),
            [&](const Rod& r) { return gap_between(r, other); });
    const RodPoints one = rod_points(rod, other, kMargin), turned = rod_points(other, rod, kMargin);
    ASSERT_GT(one.count, 0);
    ASSERT_NEAR(deepest(one), deepest(turned), kEqual + 1e-9);
    if (one.count != 1 || turned.count != 1) continue;
    ASSERT_LT((from_bullet(one.points[0].normal) + from_bullet(turned.points[0].normal)).norm(), 1e-4);
  }
}

TEST(PrimitiveContacts, ARodIsAsFarFromABoxAsASlowSearchFinds) {
  std::mt19937_64 random(43);
  int touching = 0, apart = 0, two = 0, edges = 0;
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    const Vec3 half_extents(uniform(random, 0.1, 1), uniform(random, 0.1, 1), uniform(random, 0.1, 1));
    Rod rod = random_rod(random, i);
    Vec3 way = random_vector(random, 1).normalized();
    if (i % 3 == 0) way = Vec3::Unit(i % 9 / 3);
    move_to(rod, way, uniform(random, -0.9 * rod.radius, 0.04),
            [&](const Rod& r) { return gap_to_box(r, half_extents); });
    const double gap = gap_to_box(rod, half_extents);
    const RodPoints found = rod_points(rod, vector(half_extents), kMargin);
    if (found.count == 0) {
      ASSERT_GT(gap, kMargin - 1e-6);
      ++apart;
      continue;
    }
    ++touching, two += found.count == 2;
    ASSERT_NEAR(deepest(found), gap, kEqual + 1e-6);
    ASSERT_GE(deepest(found), gap - 1e-6);
    std::set<std::pair<int, int>> features;
    for (const RodPoint& point : all(found)) {
      features.emplace(point.features.of_a, point.features.of_b);
      edges += from_bullet(point.normal).cwiseAbs().maxCoeff() < 0.999;
      ASSERT_NEAR(from_bullet(point.normal).norm(), 1, 1e-9);
      ASSERT_LE(point.gap, kMargin);
      ASSERT_LT(outside_of_box(from_bullet(point.on_other), half_extents), 1e-9);
      ASSERT_GT((from_bullet(point.on_other).cwiseAbs() - half_extents).maxCoeff(), -1e-9) << "it is inside of the box";
      const btVector3 on_segment = point.on_other + point.normal * (point.gap + rod.radius);
      ASSERT_LT(distance_from_segment(on_segment, rod), 1e-6);
      ASSERT_NEAR(outside_of_box(from_bullet(on_segment), half_extents), point.gap + rod.radius, 1e-6);
    }
    ASSERT_EQ(features.size(), static_cast<std::size_t>(found.count)) << "two points have the same features";
  }
  EXPECT_GT(touching, 2000);
  EXPECT_GT(apart, 300);
  EXPECT_GT(two, 300);
  EXPECT_GT(edges, 500);
}

/// The segment of the rod is in the box: pushed out by the overlap it touches the box, and no way out is shorter.
TEST(PrimitiveContacts, ARodInABoxLeavesItOnTheShortestWay) {
  std::mt19937_64 random(44);
  int faces = 0, edges = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const Vec3 half_extents(uniform(random, 0.1, 1), uniform(random, 0.1, 1), uniform(random, 0.1, 1));
    Rod rod = random_rod(random, i);
    rod.centre = vector(random_vector(random, 1.5).cwiseProduct(half_extents));
    if (gap_to_box(rod, half_extents) > -rod.radius) continue;
    const RodPoints found = rod_points(rod, vector(half_extents), kMargin);
    ASSERT_GT(found.count, 0);
    const auto moved = [&](const Vec3& by) {
      Rod result = rod;
      result.centre += vector(by);
      return result;
    };
    const RodPoint& point = *std::ranges::min_element(all(found), {}, &RodPoint::gap);
    const double depth = -point.gap - rod.radius;  // of the segment
    ASSERT_GE(depth, -1e-6);
    const Vec3 out = from_bullet(point.normal);
    ASSERT_GT(gap_to_box(moved(out * (depth + kEqual + 1e-4)), half_extents), -rod.radius) << "it still is inside";
    (out.cwiseAbs().maxCoeff() > 0.99999 ? faces : edges) += 1;
    for (int k = 0; k < 200; ++k) {
      const Vec3 way = random_vector(random, 1).normalized();
      if (depth < 2e-3) continue;
      ASSERT_LT(gap_to_box(moved(way * (depth - kEqual - 1e-3)), half_extents), 1e-4 - rod.radius);
    }
  }
  EXPECT_GT(faces, 300);
  EXPECT_GT(edges, 20);
}

Rod along_x(double x, double z, double tilt_rad = 0) {
  return {btVector3(x, 0, z), btVector3(std::cos(tilt_rad), 0, -std::sin(tilt_rad)), 0.25};
}

TEST(PrimitiveContacts, ACapsuleThatLiesHasTwoPoints) {
  const btVector3 table(2, 2, 0.5);
  for (const double gap : {0.0, 0.01, -0.01}) {
    SCOPED_TRACE(gap);
    const RodPoints on_box = rod_points(along_x(0.3, 0.75 + gap), table, kMargin);
    const RodPoints on_rod = rod_points(along_x(0.3, 0.5 + gap), along_x(0, 0), kMargin);
    ASSERT_EQ(on_box.count, 2);
    ASSERT_EQ(on_rod.count, 2);
    for (const RodPoint& point : all(on_box)) {
      EXPECT_EQ(point.normal, btVector3(0, 0, 1));
      EXPECT_NEAR(point.gap, gap, 1e-12);
      EXPECT_NEAR(std::abs(point.on_other.x() - 0.3), 1, 1e-12);
    }
    for (const RodPoint& point : all(on_rod)) {
      EXPECT_NEAR(point.gap, gap, 1e-12);
      EXPECT_NEAR(std::abs(point.on_other.x() - 0.15), 0.85, 1e-12) << "the ends of the common part";
    }
  }
  const RodPoints tilted = rod_points(along_x(0, 0.75, 0.005), table, kMargin);
  ASSERT_EQ(tilted.count, 2) << "both ends are near enough";
  EXPECT_NEAR(tilted.points[1].gap - tilted.points[0].gap, -2 * std::sin(0.005), 1e-12);
}

TEST(PrimitiveContacts, ACapsuleOverAnEdgeTouchesItAndTheFace) {
  const btVector3 table(2, 2, 0.5);
  const RodPoints level = rod_points(along_x(1.5, 0.75), table, kMargin);
  ASSERT_EQ(level.count, 2);
  EXPECT_NEAR(level.points[0].on_other.x(), 0.5, 1e-12);
  EXPECT_NEAR(level.points[1].on_other.x(), 2, 1e-12);
  // hangs down beyond the edge: the edge is nearest, and the end on the table still is near
  const RodPoints hangs = rod_points(along_x(1.5, 0.75, 0.01), table, kMargin);
  ASSERT_EQ(hangs.count, 2);
  const auto nearest = std::ranges::min_element(all(hangs), {}, &RodPoint::gap);
  EXPECT_GT(nearest->normal.z(), 0.9999);
  EXPECT_NEAR(nearest->on_other.x(), 2, 1e-12);
}

TEST(PrimitiveContacts, ACapsuleThatStandsOrCrossesHasOnePoint) {
  const Rod stands{btVector3(0, 0, 1.75), btVector3(0, 0, 1), 0.25};
  EXPECT_EQ(rod_points(stands, btVector3(2, 2, 0.5), kMargin).count, 1);
  EXPECT_EQ(rod_points(stands, {btVector3(0, 0, -0.75), btVector3(0, 0, 1), 0.25}, kMargin).count, 1);
  const Rod crosses{btVector3(0.3, 0.2, 0.5), btVector3(0, 1, 0), 0.25};
  const RodPoints found = rod_points(crosses, along_x(0, 0), kMargin);
  ASSERT_EQ(found.count, 1);
  EXPECT_NEAR(found.points[0].on_other.x(), 0.3, 1e-12);
  EXPECT_NEAR(found.points[0].on_other.z(), 0.25, 1e-12);
}

TEST(PrimitiveContacts, AxesThatMeetHaveANormalAllTheSame) {
  const Rod ball{btVector3(0, 0, 0), btVector3(0, 0, 0), 0.25};
  const Rod crosses{btVector3(0, 0, 0), btVector3(0, 1, 0), 0.25};
  for (const auto& [one, other] : {std::pair{ball, ball},
                                   {ball, along_x(0, 0)},
                                   {along_x(0, 0), along_x(0, 0)},
                                   {along_x(0, 0), along_x(1, 0)},
                                   {crosses, along_x(0, 0)}}) {
    const RodPoints found = rod_points(one, other, kMargin);
    ASSERT_GT(found.count, 0);
    for (const RodPoint& point : all(found)) {
      EXPECT_NEAR(from_bullet(point.normal).norm(), 1, 1e-12);
      EXPECT_NEAR(point.gap, -0.5, 1e-9);
      EXPECT_NEAR(point.normal.dot(one.half), 0, 1e-9);
      EXPECT_NEAR(point.normal.dot(other.half), 0, 1e-9);
    }
  }
}

TEST(PrimitiveContacts, ABodyWhosePoseIsNotFiniteTouchesNothing) {
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(rod_points(along_x(x, 0), along_x(0, 0), kMargin).count, 0);
    EXPECT_EQ(rod_points(along_x(x, 0), btVector3(1, 1, 1), kMargin).count, 0);
  }
}

TEST(PrimitiveContacts, PointsOnAPlaneAreTheEndsThatAreNear) {
  std::mt19937_64 random(45);
  int ends[3] = {};
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const HalfSpace plane{vector(random_vector(random, 1).normalized()), uniform(random, -3, 3)};
    Rod rod = random_rod(random, i);
    if (i % 3 == 0) rod.half -= plane.normal * rod.half.dot(plane.normal);  // it lies
    const double wanted = uniform(random, -0.2, 0.04);
    const double low = std::min(plane.above(rod.at(-1)), plane.above(rod.at(1))) - rod.radius;
    rod.centre += plane.normal * (wanted - low);
    const PlanePoints found = plane_points(rod, plane, kMargin);
    ASSERT_EQ(found.count > 0, wanted <= kMargin);
    double deepest = kMargin;
    for (const PlanePoint& point : std::span(found.points).first(static_cast<std::size_t>(found.count))) {
      ASSERT_NEAR(plane.above(point.on_plane), 0, 1e-9);
      const btVector3 centre = point.on_plane + plane.normal * (point.gap + rod.radius);
      ASSERT_LT(distance_from_segment(centre, rod), 1e-9);
      deepest = std::min(deepest, double{point.gap});
    }
    if (found.count > 0) {
      ASSERT_NEAR(deepest, wanted, 1e-9);
    }
    ++ends[found.count];
  }
  for (const int count : ends) EXPECT_GT(count, 100);
}

Settings soft() {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = true;
  return settings;
}

/// Bodies of a kind on a fixed box, whose upper side is at z = 1.
core::Scene scene_on_a_table(const core::Shape& shape) {
  core::Scene scene = scene_of(shape);
  scene.prototypes[0].can_sleep = false;
  core::StaticBody table;
  table.name = "table";
  table.shape = static_cast<std::uint32_t>(scene.shapes.size());
  table.pose.p_WB = {0, 0, 0.5};
  scene.shapes.push_back({"table", core::Box{{2, 2, 0.5}}});
  scene.statics.push_back(table);
  return scene;
}

TEST(PrimitiveContacts, ACapsuleComesToRestOnABox) {
  const core::Scene scene = scene_on_a_table(core::Capsule{0.2, 0.8});
  RegionWorld world(scene, soft());
  core::BodyRecord capsule = body(1, 0, {0, 0, 1.6});
  capsule.R_WB = Eigen::AngleAxisd(1.3, Vec3::UnitY()).toRotationMatrix();
  world.add(std::vector{capsule});
  run(world, 600);
  const core::ClusterState all = world.peek_all();
  ASSERT_EQ(all.manifolds.size(), 1u);
  EXPECT_EQ(all.manifolds[0].point_count, 2u);
  EXPECT_NEAR(world.records()[0].p_WB.z(), 1.2, 2e-3);
  EXPECT_LT(world.records()[0].v_WB.norm(), 1e-3);
}

}  // namespace
}  // namespace aurasim::physics::testing
