// Contacts of hulls and boxes against a slow search over all axes, and what they promise to the step.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "physics/hull_axes.h"
#include "physics/hull_clip.h"
#include "physics/hull_faces.h"
#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

constexpr double kMargin = 0.02, kExact = 1e-9;
/// Axes that differ by less may be chosen for each other.
constexpr double kEqual = kMargin / 40;

Vec3 from(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

Vec3 random_vector(std::mt19937_64& random, double half) {
  const double x = uniform(random, -half, half), y = uniform(random, -half, half);
  return {x, y, uniform(random, -half, half)};
}

btTransform thrown_pose(std::mt19937_64& random, double apart_m) {
  const Vec3 p = random_vector(random, 1).normalized() * apart_m;
  btQuaternion q(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  return btTransform(q.normalized(), btVector3(p.x(), p.y(), p.z()));
}

std::vector<Vec3> box_points(const Vec3& half) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) {
    points.emplace_back((i & 1 ? 1 : -1) * half.x(), (i & 2 ? 1 : -1) * half.y(), (i & 4 ? 1 : -1) * half.z());
  }
  return points;
}

enum Form { kCube, kPlate, kNeedle, kTetrahedron, kRound, kOnAGrid, kForms };

std::vector<Vec3> random_points(std::mt19937_64& random, int form) {
  switch (form) {
    case kCube:
      return box_points({uniform(random, 0.1, 0.4), uniform(random, 0.1, 0.4), uniform(random, 0.1, 0.4)});
    case kPlate:
      return box_points({0.4, 0.3, 0.005});
    case kNeedle:
      return box_points({0.5, 0.01, 0.01});
    default:
      break;
  }
  std::vector<Vec3> points;
  const int count = form == kTetrahedron ? 4 : form == kRound ? 16 : 12;
  while (static_cast<int>(points.size()) < count) {
    Vec3 p = random_vector(random, 1).normalized() * uniform(random, 0.3, 0.5);
    if (form == kOnAGrid) p = (p * 5).array().round() / 5;  // many points in one plane, some twice
    points.push_back(p);
  }
  return points;
}

/// A hull, with what the slow search needs: its faces and edges by trying all triples and pairs of points.
struct Hull {
  explicit Hull(std::vector<Vec3> of) : points(std::move(of)), faces(hull_faces(points)) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = 0; j < points.size(); ++j) {
        for (std::size_t k = 0; k < points.size(); ++k) {
          const Vec3 across = (points[j] - points[i]).cross(points[k] - points[i]);
          if (across.norm() < 1e-6) continue;
          const Vec3 n = across.normalized();
          const bool is_face = std::ranges::all_of(points, [&](const Vec3& p) { return n.dot(p - points[i]) < 1e-9; });
          const bool is_known = std::ranges::any_of(normals, [&](const Vec3& m) { return (m - n).norm() < 1e-6; });
          if (is_face && !is_known) normals.push_back(n);
        }
      }
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 along = points[j] - points[i];
        if (along.norm() < 1e-6) continue;
        const auto meets = [&](const Vec3& n) {
          return n.dot(points[i]) > reach(n) - 1e-9 && std::abs(n.dot(along)) < 1e-9;
        };
        if (std::ranges::count_if(normals, meets) >= 2) edges.push_back(along);
      }
    }
  }
  /// How far the hull reaches along d.
  double reach(const Vec3& d) const {
    double far = -std::numeric_limits<double>::infinity();
    for (const Vec3& p : points) far = std::max(far, d.dot(p));
    return far;
  }
  /// How far p is outside of the hull's planes.
  double outside(const Vec3& p) const {
    double far = -std::numeric_limits<double>::infinity();
    for (const Vec3& n : normals) far = std::max(far, n.dot(p) - reach(n));
    return far;
  }

  std::vector<Vec3> points, normals, edges;
  std::unique_ptr<const HullFaces> faces;
};

struct Two {
  const Hull &a, &b;
  btTransform X_AB;

  Vec3 turned(const Vec3& v) const { return from(X_AB.getBasis() * btVector3(v.x(), v.y(), v.z())); }
  Vec3 in_b(const btVector3& p) const { return from(X_AB.invXform(p)); }
  /// The gap along n, which points from A to B.
  double gap(const Vec3& n) const {
    const btVector3 back = btVector3(n.x(), n.y(), n.z()) * X_AB.getBasis();
    return from(X_AB.getOrigin()).dot(n) - b.reach(-from(back)) - a.reach(n);
  }
  /// The largest gap along all normals of faces and across all pairs of edges.
  double widest() const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec3& n : a.normals) most = std::max(most, gap(n));
    for (const Vec3& n : b.normals) most = std::max(most, gap(-turned(n)));
    for (const Vec3& u : a.edges) {
      for (const Vec3& v : b.edges) {
        const Vec3 across = u.cross(turned(v));
        if (across.norm() < 1e-4 * u.norm() * v.norm()) continue;
        most = std::max({most, gap(across.normalized()), gap(-across.normalized())});
      }
    }
    return most;
  }

  std::optional<HullGap> closest(HullAxis last = {}) const {
    return closest_axis(*a.faces, *b.faces, X_AB, kMargin, last);
  }
  HullPoints contacts(const HullGap& along) const {
    return contact_points(*a.faces, *b.faces, X_AB, along, kMargin, {});
  }
};

/// Pairs of hulls of random forms: some apart, some that touch, some that overlap deeply.
template <class Check>
void for_random_pairs(int count, Check&& check) {
  std::mt19937_64 random(41);
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    const Hull a(random_points(random, i % kForms)), b(random_points(random, i / kForms % kForms));
    ASSERT_TRUE(a.faces && b.faces);
    Two two{a, b, thrown_pose(random, uniform(random, 0, 1))};
    if (i % 3 != 0) {  // moves them until they nearly touch
      const Vec3 d = from(two.X_AB.getOrigin()).normalized();
      two.X_AB.setOrigin(two.X_AB.getOrigin() -
                         btVector3(d.x(), d.y(), d.z()) * (two.widest() - uniform(random, -0.02, 0.02)));
    }
    ASSERT_NO_FATAL_FAILURE(check(two, random));
  }
}

TEST(HullContacts, TheAxisIsTheBestOfAll) {
  int touching = 0, apart = 0, deep = 0;
  for_random_pairs(1500, [&](const Two& two, std::mt19937_64&) {
    const double widest = two.widest();
    const std::optional<HullGap> found = two.closest();
    if (!found) {
      ASSERT_GT(widest, kMargin - kExact);
      ++apart;
      return;
    }
    ASSERT_NEAR(from(found->normal).norm(), 1, kExact);
    ASSERT_NEAR(two.gap(from(found->normal)), found->gap, 1e-7);
    ASSERT_LE(found->gap, kMargin + kExact);
    // The slow search also finds axes of hulls apart that belong to no closest points.
    if (widest > 0) return;
    const double inner = (two.a.faces->inner_radius + two.b.faces->inner_radius) / 2;
    const btVector3 centres = two.X_AB(two.b.faces->centre) - two.a.faces->centre;
    const bool may_leave_out_edges = centres.length() < inner;
    if (!may_leave_out_edges) {
      ASSERT_GE(found->gap, widest - kEqual - 1e-7);
    }
    ++(may_leave_out_edges ? deep : touching);
  });
  EXPECT_GT(touching, 300);
  EXPECT_GT(apart, 150);
  EXPECT_GT(deep, 20);
}

TEST(HullContacts, PointsLieOnBothBodiesAndTheDeepestIsAmongThem) {
  int full = 0, edges = 0;
  for_random_pairs(1500, [&](const Two& two, std::mt19937_64&) {
    const std::optional<HullGap> along = two.closest();
    if (!along) return;
    const HullPoints found = two.contacts(*along);
    if (along->gap < 0) {
      ASSERT_GT(found.count, 0);
    }
    std::set<std::pair<int, int>> features;
    double deepest = std::numeric_limits<double>::infinity();
    for (const HullPoint& point : std::span(found.points).first(static_cast<std::size_t>(found.count))) {
      ASSERT_NEAR(from(point.on_b - point.on_a).dot(from(found.normal)), point.gap, 1e-7);
      ASSERT_LE(point.gap, kMargin + kExact);
      features.emplace(point.features.of_a, point.features.of_b);
      deepest = std::min(deepest, point.gap);
      if (along->gap < -0.1) continue;  // an edge may be left out, and then the faces need not lie over each other
      ASSERT_LE(two.a.outside(from(point.on_a)), 1e-5);
      ASSERT_LE(two.b.outside(two.in_b(point.on_b)), 1e-5);
    }
    ASSERT_EQ(features.size(), static_cast<std::size_t>(found.count)) << "two points have the same features";
    if (found.count > 0 && std::abs(along->gap) < 0.02) {
      ASSERT_NEAR(deepest, along->gap, 2 * kEqual);
    }
    full += found.count == 4, edges += along->axis.kind == HullAxis::Kind::kEdges;
  });
  EXPECT_GT(full, 50);
  EXPECT_GT(edges, 50);
}

bool same_bits(const std::optional<HullGap>& x, const std::optional<HullGap>& y) {
  if (!x || !y) return !x && !y;
  return x->axis.kind == y->axis.kind && x->axis.of_a == y->axis.of_a && x->axis.of_b == y->axis.of_b &&
         x->normal == y->normal && x->gap == y->gap;
}

TEST(HullContacts, AnAxisToTryFirstChangesNoBit) {
  for_random_pairs(1500, [](const Two& two, std::mt19937_64& random) {
    const std::optional<HullGap> wanted = two.closest();
    HullAxis last;
    closest_axis(*two.a.faces, *two.b.faces, two.X_AB, kMargin, last);
    ASSERT_TRUE(same_bits(two.closest(last), wanted));
    for (int i = 0; i < 10; ++i) {
      const auto pick = [&](std::size_t of) { return static_cast<std::uint32_t>(random() % of); };
      const HullAxis any[] = {
          {HullAxis::Kind::kFaceOfA, pick(two.a.faces->face_count()), 0},
          {HullAxis::Kind::kFaceOfB, 0, pick(two.b.faces->face_count())},
          {HullAxis::Kind::kEdges, pick(two.a.faces->edges.size()), pick(two.b.faces->edges.size())}};
      for (const HullAxis& first : any) ASSERT_TRUE(same_bits(two.closest(first), wanted));
    }
  });
}

TEST(HullContacts, TheOtherWayRoundThePointsAreTheSame) {
  for_random_pairs(700, [](const Two& two, std::mt19937_64&) {
    const Two turned{two.b, two.a, two.X_AB.inverse()};
    const std::optional<HullGap> one = two.closest(), other = turned.closest();
    ASSERT_EQ(one.has_value(), other.has_value());
    if (!one) return;
    ASSERT_NEAR(one->gap, other->gap, kEqual + 1e-7);
    if (one->axis.of_a == other->axis.of_b && one->axis.of_b == other->axis.of_a) {
      ASSERT_LT((from(one->normal) + two.turned(from(other->normal))).norm(), 1e-6);
    }
  });
}

TEST(HullContacts, HullsThatPassEachOtherTouchNowhereOnTheWay) {
  int pass = 0, meet = 0;
  for_random_pairs(1000, [&](const Two& two, std::mt19937_64& random) {
    const Vec3 way = random_vector(random, 0.3);
    Two moved = two;
    double least = two.widest();
    for (int i = 0; i <= 10; ++i) {
      const Vec3 by = way * (i / 10.0);
      moved.X_AB.setOrigin(two.X_AB.getOrigin() + btVector3(by.x(), by.y(), by.z()));
      least = std::min(least, moved.widest());
    }
    if (stay_apart(*two.a.faces, *two.b.faces, two.X_AB, {way.x(), way.y(), way.z()})) {
      ASSERT_GT(least, 0);
      ++pass;
    } else {
      meet += least < 0;
    }
  });
  EXPECT_GT(pass, 200);
  EXPECT_GT(meet, 200);
}

/// A cube that stands exactly on another one, or over its edge, or corner on corner.
TEST(HullContacts, FacesEdgesAndCornersThatFitExactly) {
  const Hull cube(box_points({0.5, 0.5, 0.5}));
  const auto contacts_at = [&](const btVector3& p) {
    const Two two{cube, cube, btTransform(btQuaternion::getIdentity(), p)};
    const std::optional<HullGap> along = two.closest();
    return along ? two.contacts(*along) : HullPoints{};
  };
  for (const double gap : {0.0, 0.01, -0.01}) {
    SCOPED_TRACE(gap);
    const HullPoints on_top = contacts_at({0, 0, 1 + gap});
    ASSERT_EQ(on_top.count, 4);
    EXPECT_EQ(on_top.normal, btVector3(0, 0, 1));
    for (const HullPoint& point : on_top.points) EXPECT_NEAR(point.gap, gap, kExact);
    const HullPoints beside = contacts_at({0.25, 0.3, 1 + gap});
    ASSERT_EQ(beside.count, 4);
    for (const HullPoint& point : beside.points) EXPECT_NEAR(std::abs(point.on_a.x() - 0.125), 0.375, kExact);
  }
  EXPECT_GT(contacts_at({1, 1, 0}).count, 0) << "edge on edge";
  EXPECT_GT(contacts_at({1, 1, 1}).count, 0) << "corner on corner";
  EXPECT_EQ(contacts_at({1.03, 0, 0}).count, 0);
  const HullPoints same_place = contacts_at({0, 0, 0});
  ASSERT_GT(same_place.count, 0);
  EXPECT_NEAR(same_place.points[0].gap, -1, kExact);
}

TEST(HullContacts, CoplanarTrianglesAreOneFaceAndPointsInsideNone) {
  std::vector<Vec3> points = box_points({0.3, 0.2, 0.1});
  points.emplace_back(0, 0, 0);
  points.emplace_back(0.1, 0.05, 0.1);
  points.emplace_back(0.3, 0.2, 0.1);
  for (Vec3& p : points) p += Vec3(1, 2, 3);
  const auto hull = hull_faces(points);
  ASSERT_TRUE(hull);
  EXPECT_EQ(hull->face_count(), 6u);
  EXPECT_EQ(hull->edges.size(), 12u);
  EXPECT_EQ(hull->corners.size(), 8u);
  EXPECT_NEAR(hull->inner_radius, 0.1, 1e-6);
  for (const HullFaces::Edge& edge : hull->edges) {
    EXPECT_GT(hull->normals[edge.left].cross(hull->normals[edge.right]).dot(hull->along(edge)), 0);
  }
}

TEST(HullContacts, DegenerateHullsAreBearable) {
  std::mt19937_64 random(7);
  int with_faces = 0;
  const auto degenerate = [&] {
    std::vector<Vec3> points;
    const double thickness = std::pow(10, uniform(random, -9, -1));
    const auto count = 1 + random() % 40;
    while (points.size() < count) {
      Vec3 p = random_vector(random, 0.5);
      p.z() *= thickness;
      if (random() % 2 == 0) p.y() *= thickness;
      if (random() % 3 == 0 && !points.empty()) p = points[random() % points.size()] + random_vector(random, 1e-8);
      if (random() % 5 == 0) p = (p * 4).array().round() / 4;
      points.push_back(p);
    }
    return points;
  };
  for (int i = 0; i < 3000; ++i) {
    const auto a = hull_faces(degenerate()), b = hull_faces(degenerate());
    if (!a || !b) continue;
    ++with_faces;
    const btTransform X_AB = thrown_pose(random, i % 5 == 0 ? 0 : uniform(random, 0, 0.6));
    HullAxis last;
    const std::optional<HullGap> along = closest_axis(*a, *b, X_AB, kMargin, last);
    if (!along) continue;
    ASSERT_TRUE(std::isfinite(along->gap));
    const HullPoints found = contact_points(*a, *b, X_AB, *along, kMargin, {});
    for (int k = 0; k < found.count; ++k) {
      const HullPoint& point = found.points[static_cast<std::size_t>(k)];
      ASSERT_TRUE(from(point.on_a).allFinite() && from(point.on_b).allFinite() && std::isfinite(point.gap));
    }
  }
  EXPECT_GT(with_faces, 1000);
}

TEST(HullContacts, ABodyWhosePoseIsNotFiniteTouchesNothing) {
  const Hull cube(box_points({0.5, 0.5, 0.5})), tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  EXPECT_TRUE((Two{cube, cube, btTransform(btQuaternion::getIdentity(), {0, 0.9, 0})}.closest()));
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Two two{tetrahedron, cube, btTransform(btQuaternion::getIdentity(), {x, 0, 0})};
    EXPECT_FALSE(two.closest());
    EXPECT_FALSE(two.closest({HullAxis::Kind::kFaceOfA, 1, 0}));
  }
}

core::ConvexHull prism(int sides, double radius, double half_height) {
  core::ConvexHull hull;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * M_PI * i / sides;
    for (const double z : {-half_height, half_height}) {
      hull.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  return hull;
}

Settings soft() {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = true;
  return settings;
}

/// Prisms on top of each other, each turned against the one below.
RegionWorld tower(const core::Scene& scene, int high, const Settings& settings) {
  RegionWorld world(scene, settings);
  std::vector<core::BodyRecord> bodies;
  for (int i = 0; i < high; ++i) {
    bodies.push_back(body(bodies.size() + 1, 0, {0.002 * (i % 3), 0.003 * (i % 2), 0.2 + 0.4 * i}));
    bodies.back().R_WB = Eigen::AngleAxisd(0.3 * i, Vec3::UnitZ()).toRotationMatrix();
  }
  world.add(bodies);
  return world;
}

TEST(HullContacts, ATowerOfHullsStands) {
  for (const int sides : {3, 5, 9}) {
    SCOPED_TRACE(sides);
    core::Scene scene = scene_of(prism(sides, 0.4, 0.2));
    scene.prototypes[0].can_sleep = false;
    RegionWorld world = tower(scene, 6, soft());
    run(world, 600);
    for (std::size_t i = 0; i < 6; ++i) {
      const core::BodyState& state = world.snapshot().bodies[i];
      EXPECT_NEAR(state.pose.p_WB.z(), 0.2 + 0.4 * static_cast<double>(i), 0.005);
      EXPECT_LT(state.v_WB.norm(), 0.01);
    }
  }
}

/// Columns 37 and 38 of the rows of contacts between bodies.
std::set<std::vector<double>> features_of_all(const RegionWorld& world) {
  const core::ClusterState all = world.peek_all();
  std::set<std::vector<double>> features;
  for (const core::ManifoldRecord& manifold : all.manifolds) {
    if (manifold.object0 < 0 || manifold.object1 < 0) continue;
    for (std::uint32_t i = 0; i < manifold.point_count; ++i) {
      const double* row = &all.points[(manifold.first_point + i) * core::kContactPointDoubles];
      features.insert({static_cast<double>(manifold.object0), static_cast<double>(manifold.object1), row[37], row[38]});
    }
  }
  return features;
}

TEST(HullContacts, AtRestPointsKeepTheirFeatures) {
  core::Scene scene = scene_of(prism(7, 0.4, 0.2));
  scene.prototypes[0].can_sleep = false;
  RegionWorld world = tower(scene, 4, soft());
  run(world, 300);
  const auto features = features_of_all(world);
  EXPECT_EQ(features.size(), 12u);
  EXPECT_FALSE(features.begin()->at(2) < 0);
  for (int i = 0; i < 60; ++i) {
    run(world, 1);
    ASSERT_EQ(features_of_all(world), features) << i;
  }
}

/// Two prisms side by side as one body, on a like one.
TEST(HullContacts, PartsOfCompoundsHaveTheirOwnPoints) {
  core::Compound pair;
  for (const double x : {-0.5, 0.5})
    pair.parts.push_back({prism(6, 0.4, 0.2), {{x, 0, 0}, core::Quat::Identity()}, std::nullopt});
  core::Scene scene = scene_of(pair);
  RegionWorld world(scene, soft());
  world.add(std::vector{body(1, 0, {0, 0, 0.2}), body(2, 0, {0.05, 0.1, 0.6})});
  run(world, 200);
  EXPECT_NEAR(world.snapshot().bodies[1].pose.p_WB.z(), 0.6, 0.003);
  const core::ClusterState all = world.peek_all();
  std::set<std::pair<int, int>> parts;
  for (const core::ManifoldRecord& manifold : all.manifolds) {
    if (manifold.object0 < 0 || manifold.object1 < 0) continue;
    EXPECT_EQ(manifold.point_count, 4u);
    const double* row = &all.points[manifold.first_point * core::kContactPointDoubles];
    EXPECT_GE(std::min(row[37], row[38]), 0);
    parts.emplace(row[39], row[40]);
  }
  EXPECT_EQ(parts, (std::set<std::pair<int, int>>{{0, 0}, {1, 1}}));
}

TEST(HullContacts, HullsRestOnBoxesAtTheHeightOfTheirFaces) {
  core::Scene scene = scene_of(prism(6, 0.4, 0.2));
  scene.shapes.push_back({"table", core::Box{{2, 2, 0.5}}});
  core::StaticBody table;
  table.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  table.pose.p_WB = {0, 0, 1};
  scene.statics.push_back(table);
  RegionWorld world(scene, soft());
  world.add(std::vector{body(1, 0, {0.1, 0.2, 1.9})});
  run(world, 300);
  EXPECT_NEAR(world.snapshot().bodies[0].pose.p_WB.z(), 1.7, 0.003);
}

}  // namespace
}  // namespace aurasim::physics::testing
