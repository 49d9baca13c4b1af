// Rays at bodies wherever they are said to be.
#include "physics/ray_scene.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

PlacedBody placed(std::uint64_t id, int kind, const core::Vec3& p_WB) {
  return {core::BodyId{id}, core::PrototypeId{static_cast<std::uint32_t>(kind)}, {p_WB, core::Quat::Identity()}};
}

class Rays : public ::testing::Test {
 protected:
  RayHit cast(const std::vector<PlacedBody>& bodies, const core::Vec3& from, const core::Vec3& direction,
              double range_m = 100, std::optional<core::BodyId> carrier = {}) const {
    const std::vector<core::Vec3> directions = {direction.normalized()};
    return rays_.cast(0, bodies, {{from, core::Quat::Identity()}, directions, range_m, carrier}).front();
  }

  core::Scene scene_ = scene_of_all_shapes();
  RayScene rays_{scene_, 1.0 / 60};
};

TEST_F(Rays, MeetWhatIsNearest) {
  const std::vector<PlacedBody> bodies = {placed(1, kBox, {10, 0, 5}), placed(2, kSphere, {5, 0, 5})};
  const RayHit hit = cast(bodies, {0, 0, 5}, {1, 0, 0});
  ASSERT_TRUE(hit.object);
  EXPECT_EQ(*hit.object, 2);
  EXPECT_NEAR(hit.normal_W.x(), -1, 1e-4);
  EXPECT_NEAR(hit.p_W.x(), hit.distance_m, 1e-9);
  EXPECT_EQ(*cast(bodies, {0, 0, 5}, {0, 0, -1}).object, -1) << "the ground";
  EXPECT_NEAR(cast(bodies, {0, 0, 5}, {0, 0, -1}).distance_m, 5, 1e-4);
  EXPECT_FALSE(cast(bodies, {0, 0, 5}, {0, 0, 1}).object);
  EXPECT_FALSE(cast(bodies, {0, 0, 5}, {1, 0, 0}, 4).object) << "out of range";
  EXPECT_EQ(*cast(bodies, {0, 0, 5}, {1, 0, 0}, 100, core::BodyId{2}).object, 1) << "through the carrier";
}

TEST_F(Rays, DoNotHangOnWhoElseIsThereOrInWhichOrder) {
  std::mt19937_64 random{11};
  std::vector<PlacedBody> bodies;
  for (std::uint64_t id = 1; id <= 200; ++id) {
    bodies.push_back(placed(id, static_cast<int>(id % kKinds),
                            {uniform(random, -20, 20), uniform(random, -20, 20), uniform(random, 0.5, 6)}));
    bodies.back().pose.q_WB = core::Quat(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), 0.5);
  }
  std::vector<core::Vec3> directions;
  for (int i = 0; i < 500; ++i) {
    directions.push_back(
        core::Vec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -0.3, 0.2)).normalized());
  }
  const RayFan fan{{{0, 0, 2}, core::Quat::Identity()}, directions, 30, {}};
  const std::vector<RayHit> all = rays_.cast(0, bodies, fan);
  std::vector<PlacedBody> backwards(bodies.rbegin(), bodies.rend());
  const std::vector<RayHit> again = rays_.cast(0, backwards, fan);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].object, again[i].object);
    EXPECT_EQ(all[i].distance_m, again[i].distance_m);
    if (!all[i].object || *all[i].object < 0) continue;
    ++hits;
    // Alone with what it has hit.
    const auto only =
        std::ranges::find(bodies, core::BodyId{static_cast<std::uint64_t>(*all[i].object)}, &PlacedBody::id);
    const std::vector<PlacedBody> one = {*only};
    const RayFan ray{fan.X_WS, std::span(directions).subspan(i, 1), 30, {}};
    EXPECT_EQ(rays_.cast(0, one, ray).front().distance_m, all[i].distance_m);
  }
  EXPECT_GT(hits, 50U);
}

TEST_F(Rays, AgreeWithTheWorldsOwn) {
  RegionWorld world(scene_, Settings{});
  const std::vector<core::BodyRecord> records = stack(10, 3, 4, 0);
  world.add(records);
  std::vector<PlacedBody> bodies;
  for (const core::BodyState& state : world.snapshot().bodies)
    bodies.push_back({state.id, state.prototype, state.pose});
  for (int i = -20; i <= 20; ++i) {
    const core::Vec3 from(0, 0.05 * i, 1.1), direction(1, 0, 0);
    const RayHit mine = cast(bodies, from, direction, 10), its = world.cast(from, from + 10 * direction);
    EXPECT_EQ(mine.object, its.object);
    if (mine.object) {
      EXPECT_NEAR(mine.distance_m, its.distance_m, 1e-4);
    }
  }
}

TEST_F(Rays, MeetStaticsWhereTheyHaveGone) {
  core::StaticBody lift;
  lift.shape = scene_.prototypes[kBox].shape;
  lift.pose.p_WB = {5, 0, 5};
  lift.path = {{{1, {{0, 0, 3}, core::Quat::Identity()}}}, false, false};
  scene_.statics.push_back(lift);
  RayScene rays(scene_, 1.0 / 60);
  const std::vector<core::Vec3> directions = {core::Vec3::UnitX()};
  const auto sees = [&](double z, core::Step step) {
    const RayFan fan{{{0, 0, z}, core::Quat::Identity()}, directions, 30, {}};
    return rays.cast(step, {}, fan).front().object == -2;
  };
  EXPECT_TRUE(sees(5, 0));
  EXPECT_TRUE(sees(6.5, 30));
  EXPECT_FALSE(sees(5, 60));
  EXPECT_TRUE(sees(8, 60));
  rays.add({1, 1, 101, core::MoveStatic{core::StaticId{1}, {{5, 0, 8}, {}}, {{5, 0, 4}, core::Quat::Identity()}, 10}});
  EXPECT_TRUE(sees(8, 100));
  EXPECT_TRUE(sees(4, 110));
}

TEST_F(Rays, MeetStaticsWhileTheyStand) {
  core::Order added;
  added.at_step = 10;
  added.action = core::AddStatic{core::StaticId{1}, scene_.prototypes[kBox].shape, {{5, 0, 5}, core::Quat::Identity()}};
  scene_.statics.push_back({"client", scene_.prototypes[kBox].shape, 0, {{5, 0, 5}, core::Quat::Identity()}});
  rays_.add(added);
  core::Order removed;
  removed.at_step = 20;
  removed.action = core::RemoveStatic{core::StaticId{1}};
  rays_.add(removed);
  const std::vector<core::Vec3> directions = {core::Vec3::UnitX()};
  const RayFan fan{{{0, 0, 5}, core::Quat::Identity()}, directions, 30, {}};
  EXPECT_FALSE(rays_.cast(9, {}, fan).front().object);
  EXPECT_EQ(rays_.cast(10, {}, fan).front().object, -2);
  EXPECT_EQ(rays_.cast(19, {}, fan).front().object, -2);
  EXPECT_FALSE(rays_.cast(20, {}, fan).front().object);
}

}  // namespace
}  // namespace aurasim::physics::testing
