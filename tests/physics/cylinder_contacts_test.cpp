// Contacts of cylinders against slow searches, and what they promise to the step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "physics/bullet_convert.h"
#include "physics/cylinder_faces.h"
#include "physics/static_floors.h"
#include "physics/two_cylinders.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

constexpr double kCylinderMargin = 0.02;
/// Points whose gaps differ by less may be chosen for each other.
constexpr double kSameGap = kCylinderMargin / 40;

btVector3 bullet(const Vec3& v) { return to_bullet(v); }

std::span<const HullPoint> all(const HullPoints& found) {
  return std::span(found.points).first(static_cast<std::size_t>(found.count));
}

double deepest_of(const HullPoints& found) {
  double gap = std::numeric_limits<double>::infinity();
  for (const HullPoint& point : all(found)) gap = std::min(gap, point.gap);
  return gap;
}

Vec3 random_direction(std::mt19937_64& random) {
  Vec3 v;
  do {
    for (int k = 0; k < 3; ++k) v[k] = uniform(random, -1, 1);
  } while (v.norm() < 0.1 || v.norm() > 1);
  return v.normalized();
}

/// A cylinder whose axis is along `axis`, about the origin.
Cylinder cylinder_along(const Vec3& axis, double half_height, double radius, double turned_rad) {
  const core::Quat q =
      core::Quat::FromTwoVectors(Vec3::UnitZ(), axis) * core::Quat(Eigen::AngleAxisd(turned_rad, Vec3::UnitZ()));
  return {btVector3(0, 0, 0),
          bullet(q * Vec3::UnitZ()),
          bullet(q * Vec3::UnitX()),
          bullet(q * Vec3::UnitY()),
          half_height,
          radius};
}

/// Often nearly or exactly along or across z.
Cylinder random_cylinder(std::mt19937_64& random, int form) {
  Vec3 axis = random_direction(random);
  if (form % 4 == 1) axis = (Vec3::UnitZ() + std::pow(10, uniform(random, -9, -1)) * axis).normalized();
  if (form % 4 == 2) axis = (axis - axis.z() * (1 - std::pow(10, uniform(random, -9, 0))) * Vec3::UnitZ()).normalized();
  if (form % 8 == 3) axis = Vec3::UnitZ();
  if (form % 8 == 7) axis = Vec3::UnitX();
  return cylinder_along(axis, uniform(random, 0.05, 0.5), uniform(random, 0.05, 0.5), uniform(random, 0, 6));
}

/// Distance from the surface along the axis or across it; negative: inside.
double outside_of(const Cylinder& cylinder, const btVector3& p) {
  const btVector3 d = p - cylinder.centre;
  const double along = d.dot(cylinder.axis), aside = (d - cylinder.axis * along).length();
  return std::max(std::abs(along) - cylinder.half_height, aside - cylinder.radius);
}

class NoSearch final : public NearestPoints {
 public:
  std::optional<SearchedPoint> find() const override { return std::nullopt; }
};

TEST(CylinderContacts, TheDeepestPointOnAPlaneIsThatOfTheCylinder) {
  std::mt19937_64 random(61);
  int counts[5] = {};
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    Cylinder cylinder = random_cylinder(random, i);
    const HalfSpace plane{btVector3(0, 0, 1), uniform(random, -3, 3)};
    const double wanted = uniform(random, -0.1, 0.03);
    cylinder.centre = btVector3(1, 2, plane.offset_m + cylinder.reach(plane.normal) + wanted);
    const HullPoints found = cylinder_contact(cylinder, plane, kCylinderMargin);
    ++counts[found.count];
    if (found.count == 0) {
      ASSERT_GT(wanted, kCylinderMargin - kSameGap);
      continue;
    }
    ASSERT_NEAR(deepest_of(found), wanted, kSameGap);
    ASSERT_GE(deepest_of(found), wanted - 1e-7);
    std::set<std::pair<int, int>> names;
    for (const HullPoint& point : all(found)) {
      names.emplace(point.features.of_a, point.features.of_b);
      ASSERT_LE(point.gap, kCylinderMargin);
      ASSERT_NEAR(outside_of(cylinder, point.on_a), 0, 1e-9);
      ASSERT_NEAR(plane.above(point.on_b), 0, 1e-9);
      ASSERT_LT((point.on_a - point.on_b - plane.normal * point.gap).length(), 1e-9);
    }
    ASSERT_EQ(names.size(), static_cast<std::size_t>(found.count)) << "two points have one name";
  }
  for (const int k : {0, 1, 2, 4}) EXPECT_GT(counts[k], 100) << k;
}

TEST(CylinderContacts, PointsOnABoxLieOnBothBodies) {
  std::mt19937_64 random(62);
  int touching = 0, full = 0, part = 0;
  for (int i = 0; i < 6000; ++i) {
    SCOPED_TRACE(i);
    const Vec3 half(uniform(random, 0.1, 1), uniform(random, 0.1, 1), uniform(random, 0.1, 1));
    const auto box = box_faces(half);
    Cylinder cylinder = random_cylinder(random, i);
    const double wanted = uniform(random, -0.04, 0.03);
    cylinder.centre = btVector3(uniform(random, -1, 1) * half.x(), uniform(random, -1, 1) * half.y(),
                                half.z() + cylinder.reach({0, 0, 1}) + wanted);
    const HullPoints found = cylinder_contact(cylinder, *box, kCylinderMargin, {}, NoSearch());
    if (found.count == 0) continue;
    ++touching;
    const btVector3 up = -found.normal;
    ASSERT_NEAR(up.length(), 1, 1e-9);
    const double gap = up.dot(cylinder.centre) - cylinder.reach(up) - box->corners.reach(up)[1];
    ASSERT_NEAR(deepest_of(found), gap, kSameGap + 1e-9) << "the normal is no separating axis";
    std::set<std::pair<int, int>> names;
    for (const HullPoint& point : all(found)) {
      names.emplace(point.features.of_a, point.features.of_b);
      part += point.features.of_b % 3 != 2;
      ASSERT_LE(point.gap, kCylinderMargin);
      ASSERT_NEAR((point.on_a - point.on_b).dot(up), point.gap, 1e-9);
      ASSERT_LT(outside_of(cylinder, point.on_a), 1e-9);
      ASSERT_LT((from_bullet(point.on_b).cwiseAbs() - half).maxCoeff(), 1e-9);
      ASSERT_GT((from_bullet(point.on_b).cwiseAbs() - half).maxCoeff(), -1e-9);
    }
    ASSERT_EQ(names.size(), static_cast<std::size_t>(found.count)) << "two points have one name";
    full += found.count == 4;
  }
  EXPECT_GT(touching, 2000);
  EXPECT_GT(full, 300);
  EXPECT_GT(part, 300);
}

/// The floor of tiles has the points of one floor, or points nearer to the middle at a joint.
TEST(CylinderContacts, ACapOverAJointOfTilesHasPointsOnBoth) {
  const auto tile = box_faces({0.5, 0.5, 0.25});
  for (const double turned_rad : {0.0, 0.3, 0.785}) {
    for (const double beyond : {-0.4, -0.2, 0.0, 0.1, 0.25}) {
      SCOPED_TRACE(beyond);
      Cylinder cylinder = cylinder_along(Vec3::UnitZ(), 0.2, 0.3, turned_rad);
      cylinder.centre = btVector3(0.5 + beyond, 0.05, 0.45);
      const HullPoints found = cylinder_contact(cylinder, *tile, kCylinderMargin, {}, NoSearch());
      ASSERT_GE(found.count, 3);
      double low = 1, high = -1;
      for (const HullPoint& point : all(found)) {
        EXPECT_NEAR(point.gap, 0, 1e-12);
        low = std::min(low, double{point.on_b.y()}), high = std::max(high, double{point.on_b.y()});
      }
      const double widest = beyond > 0 ? 2 * std::sqrt(0.09 - beyond * beyond) : 0.6;
      EXPECT_GT(high - low, 0.7 * widest) << "the points do not span the part of the cap over the tile";
    }
  }
}

TEST(CylinderContacts, ACylinderThatLiesHasTheEndsOfItsPartOverTheBox) {
  const auto table = box_faces({1, 1, 0.5});
  Cylinder cylinder = cylinder_along(Vec3::UnitX(), 0.5, 0.2, 0);
  cylinder.centre = btVector3(0.8, 0.1, 0.7);
  const HullPoints found = cylinder_contact(cylinder, *table, kCylinderMargin, {}, NoSearch());
  ASSERT_EQ(found.count, 2);
  EXPECT_NEAR(std::min(found.points[0].on_b.x(), found.points[1].on_b.x()), 0.3, 1e-12);
  EXPECT_NEAR(std::max(found.points[0].on_b.x(), found.points[1].on_b.x()), 1, 1e-12);
}

TEST(CylinderContacts, PointsOfTwoCylindersLieOnBoth) {
  std::mt19937_64 random(63);
  int caps = 0, barrels = 0, searched = 0;
  for (int i = 0; i < 6000; ++i) {
    SCOPED_TRACE(i);
    Cylinder a = random_cylinder(random, i % 2 == 0 ? 1 : i), b = random_cylinder(random, i % 2 == 0 ? 1 : i / 8);
    const Vec3 way = i % 2 == 0 ? Vec3(Vec3::UnitZ()) : random_direction(random);
    const double size = a.reach(bullet(way)) + b.reach(bullet(way)) + uniform(random, -0.03, 0.03);
    a.centre = bullet(way * size + 0.2 * random_direction(random).cwiseProduct(Vec3(1, 1, 0)));
    const std::optional<HullPoints> found = cylinder_contact(a, b, kCylinderMargin);
    if (!found) ++searched;
    if (!found || found->count == 0) continue;
    const btVector3 up = -found->normal;
    const bool is_cap = std::abs(up.dot(a.axis)) > 0.9;
    ++(is_cap ? caps : barrels);
    const double gap = up.dot(a.centre - b.centre) - a.reach(up) - b.reach(up);
    if (is_cap) {
      ASSERT_NEAR(deepest_of(*found), gap, kSameGap + 1e-7) << "the normal is no separating axis";
    }
    std::set<std::pair<int, int>> names;
    for (const HullPoint& point : all(*found)) {
      names.emplace(point.features.of_a, point.features.of_b);
      ASSERT_LE(point.gap, kCylinderMargin);
      ASSERT_LT(std::abs(outside_of(a, point.on_a)), (is_cap ? 0.003 : 0.02) * a.radius);
      ASSERT_LT(std::abs(outside_of(b, point.on_b)), (is_cap ? 0.003 : 0.02) * b.radius);
    }
    ASSERT_EQ(names.size(), static_cast<std::size_t>(found->count)) << "two points have one name";
  }
  EXPECT_GT(caps, 300);
  EXPECT_GT(barrels, 200);
  EXPECT_GT(searched, 100);
}

Settings gentle() {
  Settings settings = balanced();
  settings.step_s = 1.0 / 60;
  return settings;
}

core::BodyRecord settled(const core::Shape& shape, const core::Shape& fixed, const core::Pose& pose,
                         const core::BodyRecord& start, std::uint32_t points) {
  core::Scene scene = scene_of(shape);
  scene.prototypes[0].can_sleep = false;
  scene.statics.clear();
  scene.materials.assign(2, core::Material{});
  add_static(scene, fixed, pose);
  RegionWorld world(scene, gentle());
  world.add(std::vector{start});
  run(world, 600);
  const core::ClusterState all = world.peek_all();
  EXPECT_EQ(all.manifolds.size(), 1u);
  if (all.manifolds.size() == 1) {
    EXPECT_GE(all.manifolds[0].point_count, points);
  }
  return world.records()[0];
}

TEST(CylinderContacts, ACylinderComesToRestOnACapOrItsBarrel) {
  const core::Shape floor = core::Box{{5, 5, 0.5}};
  const core::Pose below{Vec3(0, 0, -0.5), core::Quat::Identity()};
  for (const core::Shape& ground : {floor, core::Shape(core::Plane{{0, 0, 1}, 0}), core::Shape(grid(1, 8))}) {
    const core::Pose pose = std::holds_alternative<core::Box>(ground) ? below : core::Pose{};
    core::BodyRecord start = body(1, 0, {0.2, 0.1, 0.5});
    start.R_WB = Eigen::AngleAxisd(0.3, Vec3(1, 2, 0).normalized()).toRotationMatrix();
    const core::BodyRecord stands = settled(core::Cylinder{0.3, 0.4}, ground, pose, start, 4);
    EXPECT_NEAR(stands.p_WB.z(), 0.2, 2e-3);
    EXPECT_GT(stands.R_WB(2, 2), 1 - 1e-5);
    EXPECT_LT(stands.v_WB.norm() + stands.w_WB.norm(), 1e-3);
    start.R_WB = Eigen::AngleAxisd(1.4, Vec3::UnitX()).toRotationMatrix();
    const core::BodyRecord lies = settled(core::Cylinder{0.2, 0.8}, ground, pose, start, 2);
    EXPECT_NEAR(lies.p_WB.z(), 0.2, 2e-3);
    EXPECT_NEAR(lies.R_WB(2, 2), 0, 1e-3);
  }
}

/// A pipe along the edges of two blocks, between which it would fall.
TEST(CylinderContacts, ACylinderRestsAlongTwoEdges) {
  core::Scene scene = scene_of(core::Cylinder{0.3, 0.8});
  scene.prototypes[0].can_sleep = false;
  scene.statics.clear();
  scene.materials.assign(2, core::Material{});
  for (const double side : {-1.0, 1.0}) {
    add_static(scene, core::Box{{0.5, 2, 0.5}}, {Vec3(0.68 * side, 0, 0.5), core::Quat::Identity()});
  }
  RegionWorld world(scene, gentle());
  core::BodyRecord start = body(1, 0, {0, 0, 1 + std::sqrt(0.09 - 0.18 * 0.18) + 0.01});
  start.R_WB = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()).toRotationMatrix();
  world.add(std::vector{start});
  run(world, 600);
  const core::BodyRecord pipe = world.records()[0];
  EXPECT_NEAR(pipe.p_WB.z(), 1 + std::sqrt(0.09 - 0.18 * 0.18), 5e-3);
  EXPECT_NEAR(pipe.p_WB.x(), 0, 5e-3);
  EXPECT_LT(pipe.v_WB.norm() + pipe.w_WB.norm(), 2e-3);
}

TEST(CylinderContacts, LogsRestInAPile) {
  core::Scene scene = scene_of_slider(core::Cylinder{0.2, 2});
  scene.materials[0].friction = 0.6;
  scene.prototypes[0].can_sleep = false;
  add_tiles(scene, {});
  for (const double side : {-1.0, 1.0}) {
    add_static(scene, core::Box{{0.1, 2, 0.5}}, {Vec3(0.702 * side, 0, 0.5), core::Quat::Identity()});
  }
  RegionWorld world(scene, gentle());
  std::vector<core::BodyRecord> logs;
  for (std::uint64_t i = 0; i < 5; ++i) {
    const double x = i < 3 ? 0.4 * (static_cast<double>(i) - 1) : 0.4 * (static_cast<double>(i) - 3.5);
    core::BodyRecord& log = logs.emplace_back(body(i, 0, {x, 0, i < 3 ? 0.2 : 0.5465}));
    log.R_WB = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()).toRotationMatrix();
  }
  world.add(logs);
  run(world, 900);
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const core::BodyRecord& now = world.records()[i];
    EXPECT_LT((now.p_WB - logs[i].p_WB).norm(), 0.04) << i;
    EXPECT_NEAR(now.R_WB(2, 2), 0, 2e-3) << i;
    EXPECT_LT(now.v_WB.norm() + now.w_WB.norm(), 5e-3) << i;
  }
}

/// Towers of cylinders, over joints of tiles.
TEST(CylinderContacts, ATowerOfCylindersStandsOnTiles) {
  for (const double aside_m : {0.0, 0.5, 0.21}) {
    SCOPED_TRACE(aside_m);
    core::Scene scene = scene_of_slider(core::Cylinder{0.3, 0.4});
    scene.materials[0].friction = 0.5;
    scene.prototypes[0].can_sleep = false;
    add_tiles(scene, {.aside_m = aside_m});
    RegionWorld world(scene, gentle());
    std::vector<core::BodyRecord> tower;
    for (std::uint64_t i = 0; i < 6; ++i) tower.push_back(body(i, 0, {0, 0.5, 0.2 + 0.4 * static_cast<double>(i)}));
    world.add(tower);
    run(world, 600);
    for (std::size_t i = 0; i < tower.size(); ++i) {
      const core::BodyRecord& now = world.records()[i];
      EXPECT_LT((now.p_WB - tower[i].p_WB).norm(), 0.01) << i;
      EXPECT_LT(now.v_WB.norm(), 2e-3) << i;
    }
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
