// Edges between neighbouring statics neither brake a body nor trip it up, and real edges stay (physics/inner_edges.h).
#include "physics/inner_edges.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <gtest/gtest.h>

#include "physics/joint_scenes.h"
#include "physics/static_floors.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

/// Runs a body and returns where it is then.
core::BodyRecord after(const core::Scene& scene, const core::BodyRecord& start, int steps) {
  RegionWorld world(scene, balanced());
  world.add(std::vector{start});
  run(world, steps);
  return world.records()[0];
}

TEST(InnerEdges, ASlopeOfTilesIsASlope) {
  const core::Quat q = turned(Vec3::UnitY(), 0.35);  // falls along x
  for (const Slider& slider : sliders()) {
    core::Scene one = scene_of_slider(slider.shape), tiles = scene_of_slider(slider.shape);
    add_static(one, core::Box{{50, 50, 0.25}}, {q * Vec3(0, 0, -0.25), q});
    add_tiles(tiles, {}, {Vec3::Zero(), q});
    core::BodyRecord start = record_of(slider, q * Vec3(0.13, 0.21, slider.height_m), q * Vec3(1, 0, 0));
    start.R_WB = (q * slider.q).toRotationMatrix();
    const Vec3 p_one = after(one, start, 120).p_WB - start.p_WB, p_tiles = after(tiles, start, 120).p_WB - start.p_WB;
    EXPECT_GT(p_one.x(), 4) << slider.name;
    EXPECT_NEAR(p_tiles.x(), p_one.x(), 0.01 * p_one.x()) << slider.name;
    EXPECT_NEAR(p_tiles.z(), p_one.z(), 0.01 * p_one.x()) << slider.name;
  }
}

TEST(InnerEdges, ABallRollsAlongAWallOfTiles) {
  core::Scene one = scene_of_slider(core::Sphere{0.2}), tiles = one;
  const Vec3 wall_p(0, 0.25, 1);
  add_static(one, core::Box{{50, 0.25, 3}}, {wall_p, core::Quat::Identity()});
  for (int i = 0; i < 25; ++i) {
    add_static(tiles, core::Box{{0.5, 0.25, 3}}, {Vec3(i - 2, 0, 0) + wall_p, core::Quat::Identity()});
  }
  for (core::Scene* scene : {&one, &tiles}) {
    scene->gravity = Vec3(0, 4, -9.81);  // leans against the wall
    add_one_floor(*scene);
  }
  const core::BodyRecord start = body(1, 0, {0.13, -0.2, 0.2}, {8, 0, 0});
  const core::BodyRecord at_one = after(one, start, 120), at_tiles = after(tiles, start, 120);
  EXPECT_NEAR(at_tiles.p_WB.x(), at_one.p_WB.x(), 0.01 * at_one.p_WB.x());
  EXPECT_NEAR(at_tiles.p_WB.y(), at_one.p_WB.y(), 1e-3);
}

/// A tower of boxes, over the joint of two tiles or of four, or in the middle of a tile.
TEST(InnerEdges, ATowerStandsOverAJointAsOnOneFloor) {
  for (const double aside_m : {0.0, 0.5, 0.21}) {
    core::Scene one = scene_of_slider(core::Box{{0.3, 0.3, 0.3}}), tiles = one, mesh = one;
    for (core::Scene* scene : {&one, &tiles, &mesh}) scene->materials[0].friction = 0.5;
    add_one_floor(one);
    add_tiles(tiles, {.aside_m = aside_m});
    add_static(mesh, grid(0.5), {Vec3(aside_m, aside_m / 2, 0), core::Quat::Identity()});
    std::vector<core::BodyRecord> bodies;
    for (std::uint64_t i = 0; i < 6; ++i) bodies.push_back(body(i, 0, {0, 0.5, 0.3 + 0.6 * static_cast<double>(i)}));
    const auto settled = [&](const core::Scene& scene) {
      RegionWorld world(scene, balanced());
      world.add(bodies);
      run(world, 300);
      return std::vector<core::BodyRecord>(world.records().begin(), world.records().end());
    };
    const auto on_one = settled(one), on_tiles = settled(tiles), on_mesh = settled(mesh);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (const auto& on_pieces : {on_tiles, on_mesh}) {
        const Vec3 off = on_pieces[i].p_WB - on_one[i].p_WB;
        EXPECT_NEAR(off.z(), 0, 5e-5) << "box " << i << ", moved by " << aside_m;
        EXPECT_LT(off.head<2>().norm(), 5e-3) << "box " << i << ", moved by " << aside_m;  // on one floor: 1e-3
      }
    }
  }
}

/// A cart on four wheels, with a motor in each.
core::Scene cart() {
  core::Scene scene = scene_of_slider(core::Box{{0.5, 0.25, 0.1}});
  scene.materials[0].friction = 0.8;
  scene.shapes.push_back({"wheel", core::Cylinder{0.2, 0.1}});
  core::Prototype wheel;
  wheel.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  scene.prototypes.push_back(wheel);
  place_body(scene, 0, {0, 0, 0.3});
  for (int i = 0; i < 4; ++i) {
    const Vec3 p(i % 2 == 0 ? 0.35 : -0.35, i < 2 ? 0.35 : -0.35, 0.2);
    place_body(scene, 1, p).pose.q_WB = turned(Vec3::UnitX(), std::numbers::pi / 2);
    add_joint(scene, core::HingeJoint{{}, core::JointMotor{-25, 2}}, 0, core::value_of(scene.bodies.back().id), p,
              Vec3::UnitY());
  }
  return scene;
}

TEST(InnerEdges, ACartDrivesOverTilesAndMeshesAsOverOneFloor) {
  const auto drive = [](const Floor& floor) {
    core::Scene scene = cart();
    floor.add(scene);
    RegionWorld world(scene, balanced());
    world.add(initial_records(scene));
    run(world, 180);
    return world.records()[0].p_WB;
  };
  const Vec3 one = drive(kOneFloor);
  ASSERT_GT(std::abs(one.x()), 4);
  for (const Floor& floor : floors_of_pieces()) {
    const Vec3 pieces = drive(floor);
    EXPECT_NEAR(pieces.x(), one.x(), 0.01 * std::abs(one.x())) << floor.name;
    EXPECT_NEAR(pieces.z(), one.z(), 2e-3) << floor.name;
  }
}

TEST(InnerEdges, ABodyTipsOverTheRimOfATileFloor) {
  core::Scene scene = scene_of_slider(core::Box{{0.25, 0.25, 0.25}});
  add_tiles(scene, {.length_m = 3});
  const double rim = -2 + 0.5 + 5 + 0.5;  // of the last tile
  EXPECT_LT(after(scene, body(1, 0, {rim + 0.05, 0.5, 0.25}), 120).p_WB.z(), -1);
  EXPECT_NEAR(after(scene, body(1, 0, {rim - 0.05, 0.5, 0.25}), 120).p_WB.z(), 0.25, 0.002);
  EXPECT_LT(after(scene, body(1, 0, {rim - 2, 0.5, 0.25}, {6, 0, 0}), 180).p_WB.z(), -1);
}

TEST(InnerEdges, AKerbStopsABall) {
  for (const bool tiled : {false, true}) {
    core::Scene scene = scene_of_slider(core::Sphere{0.05});
    if (tiled) add_tiles(scene, {});
    if (!tiled) add_one_floor(scene);
    add_static(scene, core::Box{{0.5, 3, 0.05}}, {Vec3(2.5, 0, 0), core::Quat::Identity()});  // 5 cm high, at x = 2
    const core::BodyRecord ball = after(scene, body(1, 0, {1, 0.2, 0.05}, {3, 0, 0}), 60);
    EXPECT_LT(ball.p_WB.x(), 1.96) << tiled;
    EXPECT_LT(ball.p_WB.z(), 0.06) << tiled;
  }
}

/// A ball that is larger than a kerb meets the kerb's edge at a slant. It comes as far as over a floor of one piece.
TEST(InnerEdges, AKerbOfTilesIsAKerb) {
  const auto roll = [](bool tiled) {
    core::Scene scene = scene_of_slider(core::Sphere{0.3});
    add_one_floor(scene);
    if (!tiled) add_static(scene, core::Box{{5, 3, 0.05}}, {Vec3(7, 0, 0), core::Quat::Identity()});
    for (int i = 0; tiled && i < 60; ++i) {
      add_static(scene, core::Box{{0.5, 0.5, 0.05}}, {Vec3(2.5 + i / 6, i % 6 - 2.5, 0), core::Quat::Identity()});
    }
    return after(scene, body(1, 0, {1, 0.2, 0.3}, {3, 0, 0}), 120).p_WB;
  };
  const Vec3 one = roll(false), tiles = roll(true);
  EXPECT_NEAR(tiles.x(), one.x(), 0.01);
  EXPECT_NEAR(tiles.z(), one.z(), 0.01);
}

/// Two walls that meet in an outside corner. A ball that flies at it is turned aside.
TEST(InnerEdges, AnOutsideCornerOfTwoWallsTurnsABallAside) {
  core::Scene scene = scene_of_slider(core::Sphere{0.2});
  scene.gravity = Vec3::Zero();
  add_static(scene, core::Box{{2, 0.1, 1}}, {Vec3(2, 0.1, 0), core::Quat::Identity()});    // along x, from x = 0
  add_static(scene, core::Box{{0.1, 2, 1}}, {Vec3(0.1, 2.2, 0), core::Quat::Identity()});  // along y, from y = 0.2
  const core::BodyRecord ball = after(scene, body(1, 0, {-1, -0.9, 0.1}, {4, 4, 0}), 60);
  EXPECT_GT(ball.v_WB.y() - ball.v_WB.x(), -4.5);
  EXPECT_LT(ball.v_WB.norm(), 4.5);  // it lost the speed towards the corner
  const core::BodyRecord past = after(scene, body(1, 0, {-1, -1.5, 0.1}, {4, 0, 0}), 60);
  EXPECT_NEAR(past.v_WB.x(), 4, 1e-6);
}

/// A post stands on the floor with an edge ahead. A box that slides against it does not turn aside.
TEST(InnerEdges, ThePostsEdgeStopsABox) {
  for (const bool hull : {false, true}) {
    for (const bool tiled : {false, true}) {
      core::Scene scene = scene_of_slider(core::Box{{0.25, 0.25, 0.25}});
      const Vec3 half(0.2, 0.2, 0.5);
      const core::Shape post = hull ? core::Shape(hull_of_box(half)) : core::Shape(core::Box{half});
      add_static(scene, post, {Vec3(2, 0, 0.5), turned(Vec3::UnitZ(), std::numbers::pi / 4)});
      if (tiled) add_tiles(scene, {});
      if (!tiled) add_one_floor(scene);
      const core::BodyRecord box = after(scene, body(1, 0, {1, 0, 0.25}, {4, 0, 0}), 60);
      EXPECT_LT(box.p_WB.x(), 2 - 0.2 * std::numbers::sqrt2 - 0.24) << hull << tiled;
      EXPECT_LT(std::abs(box.p_WB.y()), 0.06) << hull << tiled;
      EXPECT_GT(box.R_WB(2, 2), 0.99) << hull << tiled;
    }
  }
}

/// Statics of boxes, and what becomes of a ball's contact with one of them.
struct Boxes {
  void add(const btVector3& half, const btVector3& p, btScalar yaw_rad = 0) {
    shapes.push_back(std::make_unique<btBoxShape>(half));
    btCollisionObject& made = *objects.emplace_back(std::make_unique<btCollisionObject>());
    made.setCollisionShape(shapes.back().get());
    made.setWorldTransform(btTransform(btQuaternion(btVector3(0, 0, 1), yaw_rad), p));
    made.setUserIndex(-static_cast<int>(objects.size()));
    edges.insert(made, made.getWorldTransform());
  }
  std::optional<StaticContact> corrected(std::size_t i, const btVector3& normal, const btVector3& p) const {
    const btSphereShape ball(btScalar(0.3));
    const btTransform pose(btMatrix3x3::getIdentity(), p + normal * btScalar(0.3));
    const StaticContact found{normal, p, 0};
    return edges.corrected(found, *objects[i], -1, {*shapes[i], objects[i]->getWorldTransform()}, {ball, pose});
  }

  std::vector<std::unique_ptr<btBoxShape>> shapes;
  std::vector<std::unique_ptr<btCollisionObject>> objects;
  InnerEdges edges;
};

TEST(InnerEdges, AnEdgeThatEndsOnTheFloorIsReal) {
  Boxes boxes;
  boxes.add({10, 10, 1}, {0, 0, -1});
  boxes.add({btScalar(0.2), btScalar(0.2), btScalar(0.5)}, {0, 0, btScalar(0.5)}, SIMD_PI / 4);
  EXPECT_TRUE(boxes.edges.concerns(*boxes.objects[1]));
  for (const double z : {0.0, 0.3}) {
    const btVector3 p(btScalar(-0.2 * std::numbers::sqrt2), 0, btScalar(z));
    const auto contact = boxes.corrected(1, {-1, 0, 0}, p);
    ASSERT_TRUE(contact) << z;
    EXPECT_EQ(contact->normal.x(), -1) << z;
  }
}

TEST(InnerEdges, AnEdgeOfATileIsRealWhereNoTileIsBesideIt) {
  Boxes boxes;
  boxes.add({1, 1, 1}, {0, 0, -1});
  const btVector3 back(btScalar(-0.6), 0, btScalar(0.8)), edge(-1, 0, 0);
  EXPECT_FALSE(boxes.edges.concerns(*boxes.objects[0]));
  boxes.add({1, 1, 1}, {2, 0, -1});  // on the other side
  ASSERT_TRUE(boxes.corrected(0, back, edge));
  EXPECT_EQ(boxes.corrected(0, back, edge)->normal.x(), back.x());
  boxes.add({1, 1, 1}, {-2, 0, -1});
  EXPECT_FALSE(boxes.corrected(0, back, edge));  // the new tile has this contact
  EXPECT_FALSE(boxes.corrected(0, {-1, 0, 0}, edge));
  boxes.edges.remove(*boxes.objects[2]);
  EXPECT_TRUE(boxes.corrected(0, back, edge));
}

/// Two slabs that lean against each other. Upside down they make up a groove.
void add_roof(core::Scene& scene, double slope_rad) {
  for (const double side : {-1.0, 1.0}) {
    const core::Quat q = turned(Vec3::UnitY(), side * slope_rad);
    add_static(scene, core::Box{{1, 1, 0.1}}, {q * Vec3(side * 1, 0, -0.1), q});
  }
}

TEST(InnerEdges, ABallRestsInAGrooveAgainstBothSides) {
  core::Scene scene = scene_of_slider(core::Sphere{0.2});
  add_roof(scene, -std::numbers::pi / 4);
  const Vec3 p = after(scene, body(1, 0, {0.02, 0, 0.4}), 240).p_WB;
  EXPECT_NEAR(p.x(), 0, 2e-3);
  EXPECT_NEAR(p.z(), 0.2 * std::numbers::sqrt2, 2e-3);
}

TEST(InnerEdges, ABoxRestsInAGrooveAgainstBothSides) {
  core::Scene scene = scene_of_slider(core::Box{{0.2, 0.2, 0.2}});
  add_roof(scene, -std::numbers::pi / 4);
  core::BodyRecord start = body(1, 0, {0, 0, 0.2 * std::numbers::sqrt2});
  start.R_WB = turned(Vec3::UnitY(), std::numbers::pi / 4).toRotationMatrix();
  const core::BodyRecord box = after(scene, start, 240);
  EXPECT_LT((box.p_WB - start.p_WB).norm(), 5e-3);
  EXPECT_LT((box.R_WB - start.R_WB).norm(), 0.02);
}

TEST(InnerEdges, ABoxLiesAcrossARidge) {
  for (const bool mesh : {false, true}) {
    core::Scene scene = scene_of_slider(core::Box{{0.5, 0.2, 0.1}});
    scene.materials[0].friction = 0.6;
    constexpr double kSlope = 0.3;
    if (mesh) {
      core::TriangleMesh roof;
      for (const double x : {-1.0, 0.0, 1.0}) {
        for (const double y : {-1.0, 1.0}) roof.points.push_back({x, y, -std::abs(x) * std::tan(kSlope)});
      }
      roof.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
      add_static(scene, roof, {});
    } else {
      add_roof(scene, kSlope);
    }
    const core::BodyRecord box = after(scene, body(1, 0, {0, 0, 0.1}), 20);
    EXPECT_NEAR(box.p_WB.z(), 0.1, 4e-3) << mesh;
    EXPECT_GT(box.R_WB(2, 2), 0.99) << mesh;
    const core::BodyRecord tipped = after(scene, body(1, 0, {0.2, 0, 0.1}), 120);
    EXPECT_LT(tipped.p_WB.z(), 0.06) << mesh;
  }
}

/// Bodies of all kinds fall onto floors of pieces in heaps, at up to 8 m/s, and none falls through.
TEST(InnerEdges, NothingFallsThroughAFloorOfPieces) {
  for (const Settings& settings : {balanced(), exact()}) {
    for (const Floor& floor : floors_of_pieces()) {
      if (!settings.looks_once() && floor.name != "Tiles" && floor.name != "LargeTriangles") continue;  // it is slow
      core::Scene scene = scene_of_all_shapes();
      scene.statics.clear();
      scene.materials.resize(2);
      floor.add(scene);
      RegionWorld world(scene, settings);
      std::mt19937_64 random(11);
      for (std::uint64_t heap = 0; heap < 3; ++heap) {
        std::vector<core::BodyRecord> bodies = pile(random, 10 * heap, 6, 6.0 * static_cast<double>(heap) + 0.9, 0.1);
        for (core::BodyRecord& one : bodies) one.v_WB.z() -= 5;
        world.add(bodies);
      }
      run(world, 150);
      for (const core::BodyRecord& one : world.records()) {
        const bool is_beside = std::abs(one.p_WB.y()) > 2.8 || one.p_WB.x() < -1.8 || one.p_WB.x() > 19.8;
        EXPECT_TRUE(is_beside || one.p_WB.z() > 0.15) << floor.name << ", body " << core::value_of(one.id);
      }
    }
  }
}

TEST(InnerEdges, TheNumberOfThreadsChangesNoBit) {
  core::Scene scene = scene_of_all_shapes();
  scene.statics.clear();
  scene.materials.resize(2);
  add_tiles(scene, {.size_m = 0.7});
  add_static(scene, grid(0.4), {Vec3(0, 7, 0), core::Quat::Identity()});
  std::mt19937_64 random(5);
  std::vector<core::BodyRecord> bodies;
  for (std::uint64_t i = 0; i < 60; ++i) {
    for (core::BodyRecord& one : pile(random, 10 * i, 6, 0.25 * static_cast<double>(i), i % 2 == 0 ? 0 : 7)) {
      one.v_WB = {uniform(random, -8, 8), uniform(random, -8, 8), 0};
      bodies.push_back(one);
    }
  }
  std::vector<core::BodyRecord> alone;
  for (const int threads : {1, 2}) {
    Settings settings = balanced();
    settings.threads = threads;
    RegionWorld world(scene, settings);
    world.add(bodies);
    run(world, 150);
    if (threads == 1) alone.assign(world.records().begin(), world.records().end());
    EXPECT_EQ(different(world.records(), alone), std::vector<std::uint64_t>{});
  }
}

/// A tile that moves is no part of a floor. One that stands at its first place is.
TEST(InnerEdges, ATileThatHasGoneLeavesARealEdge) {
  core::Scene scene = scene_of_slider(core::Sphere{0.3});
  for (int i = 0; i < 8; ++i) {
    add_static(scene, core::Box{{0.5, 2, 0.25}}, {Vec3(i, 0, -0.25), core::Quat::Identity()});
  }
  scene.statics.change(3, [](core::StaticBody& tile) {
    tile.path = core::StaticPath{{{1, {Vec3(0, 0, -0.06), core::Quat::Identity()}}}, false, true};
  });
  const core::BodyRecord early = after(scene, body(1, 0, {0, 0.1, 0.3}), 1);
  EXPECT_NEAR(early.p_WB.z(), 0.3, 1e-3);
  RegionWorld world(scene, balanced());
  run(world, 90);  // the tile is 6 cm lower now
  world.add(std::vector{body(1, 0, {3.0, 0.1, 0.24}, {2, 0, 0})});
  run(world, 60);
  EXPECT_LT(world.records()[0].v_WB.x(), 1.7);  // it has met the edge of the next tile
}

}  // namespace
}  // namespace aurasim::physics::testing
