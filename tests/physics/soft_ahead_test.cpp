// The soft step with physics.continuous: contacts ahead of time.
#include <cmath>
#include <random>
#include <string>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <gtest/gtest.h>

#include "physics/scenes.h"
#include "physics/soft/ahead.h"

namespace aurasim::physics::testing {
namespace {

Settings ahead(bool on = true) {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = on;
  return settings;
}

/// A box of 1 cm thickness stands upright at x = 0; a ball of 0.1 m comes at 60 m/s, a metre in a step.
core::Scene thin_wall_and_ball() {
  core::Scene scene = scene_of(core::Sphere{0.1});
  scene.materials[0] = {};
  scene.gravity = core::Vec3::Zero();
  scene.shapes.push_back({"wall", core::Box{core::Vec3(0.005, 2, 2)}});
  scene.statics.clear();
  core::StaticBody wall;
  wall.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  scene.statics.push_back(wall);
  return scene;
}

TEST(SoftAhead, AFastBallDoesNotPassThroughAThinWall) {
  const core::Scene scene = thin_wall_and_ball();
  RegionWorld world(scene, ahead());
  world.add(std::vector{body(1, 0, {-2.3, 0.2, 0}, {60, 0, 0})});
  run(world, 10);
  EXPECT_NEAR(world.records()[0].p_WB.x(), -0.105, 0.005);
  EXPECT_NEAR(world.records()[0].v_WB.x(), 0, 0.01);

  RegionWorld without(scene, ahead(false));
  without.add(std::vector{body(1, 0, {-2.3, 0.2, 0}, {60, 0, 0})});
  run(without, 10);
  EXPECT_GT(without.records()[0].p_WB.x(), 1);
}

TEST(SoftAhead, WhatPassesByIsNotTouched) {
  const core::Scene scene = thin_wall_and_ball();
  RegionWorld world(scene, ahead());
  const core::Vec3 p(-2.3, 2.2, 0), v(60, 0, 0);  // past the edge, at 0.1 m from it
  world.add(std::vector{body(1, 0, p, v)});
  run(world, 10);
  EXPECT_LT((world.records()[0].p_WB - (p + v * 10 / 60)).norm(), 1e-4);
}

/// Two boxes at 20 m/s against each other, which Bullet's algorithm for boxes does not see before they overlap.
TEST(SoftAhead, BoxesMeetBeforeTheyOverlap) {
  core::Scene scene = scene_of(core::Box{});
  scene.materials[0] = {};
  scene.gravity = core::Vec3::Zero();
  scene.statics.clear();
  RegionWorld world(scene, ahead());
  world.add(std::vector{body(1, 0, {-2.01, 0, 0}, {20, 0, 0}), body(2, 0, {2.01, 0, 0}, {-20, 0, 0})});
  double deepest_m = 0;
  std::size_t collisions = 0;
  for (int i = 0; i < 20; ++i) {
    world.step();
    collisions += world.collisions().size();
    deepest_m = std::max(deepest_m, 1 - (world.records()[1].p_WB - world.records()[0].p_WB).x());
  }
  EXPECT_LT(deepest_m, 0.02);
  EXPECT_EQ(collisions, 1U);
  const core::Vec3 momentum = world.records()[0].v_WB + world.records()[1].v_WB;
  EXPECT_LT(momentum.norm(), 1e-5);
}

/// Energy: what is lost in a bounce is what a material says, also of the fall within a step.
TEST(SoftAhead, ABallThatLosesNothingComesBackUp) {
  core::Scene scene = scene_of(core::Sphere{0.25});
  scene.materials[0] = {};
  scene.materials[0].restitution = 1;
  RegionWorld world(scene, ahead());
  world.add(std::vector{body(1, 0, {0, 0, 1.25})});
  double energy = 0;
  for (int i = 0; i < 1200; ++i) {
    world.step();
    const core::BodyRecord& ball = world.records()[0];
    energy = 0.5 * ball.v_WB.squaredNorm() + 9.81 * (ball.p_WB.z() - 0.25);
  }
  EXPECT_NEAR(energy / 9.81, 1, 0.01);
}

/// Does Bullet's cast find that `a`, which is convex, meets `b` while it moves by `way`?
bool cast_hits(const btCollisionObject& a, const btCollisionObject& b, const btVector3& way) {
  const btTransform& from = a.getWorldTransform();
  const btTransform to(from.getBasis(), from.getOrigin() + way);
  btCollisionWorld::ClosestConvexResultCallback hit(from.getOrigin(), to.getOrigin());
  btCollisionWorld::objectQuerySingle(static_cast<const btConvexShape*>(a.getCollisionShape()), from, to,
                                      const_cast<btCollisionObject*>(&b), b.getCollisionShape(), b.getWorldTransform(),
                                      hit, 0);
  const btVector3 until = way * hit.m_closestHitFraction;
  return hit.hasHit() && hit.m_closestHitFraction > 0 && until.dot(-hit.m_hitNormalWorld) > 0;
}

/// Most pairs are found to pass each other without a cast. The answer is that of a cast all the same.
TEST(SoftAhead, WhatIsNotCastWouldHitNothing) {
  std::mt19937_64 random(11);
  const auto number = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto put = [&](btCollisionObject& object, btCollisionShape& shape, double apart) {
    const btQuaternion turn(number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1));
    object.setCollisionShape(&shape);
    object.setWorldTransform(
        btTransform(turn.normalized(), {number(-apart, apart), number(-apart, apart), number(-apart, apart)}));
    const bool is_plane = shape.getShapeType() == STATIC_PLANE_PROXYTYPE;
    object.setCollisionFlags(is_plane ? btCollisionObject::CF_STATIC_OBJECT : 0);
  };
  btSphereShape ball(0.2);
  btCapsuleShape capsule(0.15, 0.8);
  btBoxShape box({0.3, 0.5, 0.2});
  btCylinderShape cylinder({0.3, 0.2, 0.3});
  btStaticPlaneShape plane({0, 0, 1}, 0.1);
  btCollisionShape* const shapes[] = {&ball, &capsule, &box, &cylinder, &plane};
  int hits = 0, passes = 0;
  for (int i = 0; i < 100000; ++i) {
    btCollisionObject a, b;
    put(a, *shapes[random() % 4], 1.1), put(b, *shapes[random() % 5], 0.3);
    const btVector3 way(number(-0.6, 0.6), number(-0.6, 0.6), number(-0.6, 0.6));
    const bool hit = cast_hits(a, b, way);
    ++(hit ? hits : passes);
    ASSERT_EQ(meeting_ahead(a, b, way).has_value(), hit) << i;
    if (b.isStaticObject()) {
      ASSERT_EQ(meeting_ahead(b, a, -way).has_value(), hit) << i;
    }
  }
  EXPECT_GT(hits, 5000);
  EXPECT_GT(passes, 5000);
}

}  // namespace
}  // namespace aurasim::physics::testing
