// Bodies that no world can bear, and what clients may not make of a body.
#include <limits>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::Vec3;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class Breakdown : public ::testing::Test {
 protected:
  void place(std::uint64_t id, const Vec3& p_WB, const Vec3& v_WB = Vec3::Zero(), const Vec3& w_WB = Vec3::Zero()) {
    core::BodyRecord record = body(id, kBox, p_WB, v_WB);
    record.w_WB = w_WB;
    world.add({&record, 1});
  }
  void order(core::Step at_step, const core::Action& action) {
    world.schedule({++orders, 10 + orders, at_step, action});
  }
  std::string fault_of_the_only_removal() {
    const std::vector<Removal> removed = world.take_removed();
    return removed.size() == 1 ? removed[0].fault : "removed: " + std::to_string(removed.size());
  }

  core::Scene scene = scene_of_all_shapes();
  Settings settings = [] {
    Settings settings;
    settings.top_speed_m_s = 30;
    return settings;
  }();
  RegionWorld world{scene, settings};
  std::uint64_t orders = 0;
};

TEST_F(Breakdown, ABodyThatIsNoNumberIsTakenOutAndSaidSo) {
  place(1, {0, 0, 5}, {kNan, 0, 0});
  place(2, {5, 0, 5});
  world.step();
  EXPECT_FALSE(world.contains(BodyId{1}));
  EXPECT_TRUE(world.contains(BodyId{2}));
  EXPECT_EQ(world.snapshot().bodies.size(), 1u);
  EXPECT_NE(fault_of_the_only_removal().find("not finite"), std::string::npos);
}

TEST_F(Breakdown, ABodyOutOfAllBoundsIsTakenOut) {
  place(1, {0, 0, 5}, {1e7, 0, 0});
  world.step();
  EXPECT_NE(fault_of_the_only_removal().find("too fast"), std::string::npos);
  place(2, {1e7 - 1, 0, 500}, {100, 0, 0});
  run(world, 2);
  EXPECT_NE(fault_of_the_only_removal().find("too far out"), std::string::npos);
}

/// State 1 is the first without it, wherever it is computed: also where late bodies make up states.
TEST_F(Breakdown, TakesPlaceInTheSameStateInTheScratchWorld) {
  run(world, 3);
  core::ClusterState cluster;
  cluster.bodies = {body(1, kBox, {0, 0, 5}, {1e7, 0, 0}), body(2, kBox, {9, 0, 5})};
  world.adopt(cluster, 0);
  EXPECT_FALSE(world.contains(BodyId{1}));
  EXPECT_TRUE(world.contains(BodyId{2}));
  const std::vector<Removal> removed = world.take_removed();
  ASSERT_EQ(removed.size(), 1u);
  EXPECT_EQ(removed[0].step, 1);
}

TEST_F(Breakdown, WhoTouchesNothingOfItFeelsNothing) {
  RegionWorld alone{scene, settings};
  core::BodyRecord other = body(2, kSphere, {5, 0, 2}, {1, 2, 0});
  alone.add({&other, 1});
  world.add({&other, 1});
  place(1, {-5, 0, 2}, {kNan, 0, 0});
  run(world, 60);
  run(alone, 60);
  EXPECT_EQ(hash_sum(world.records()), hash_sum(alone.records()));
}

TEST_F(Breakdown, AnImpulseThatWouldMakeABodyTooFastIsDeclined) {
  place(1, {0, 0, 50});
  order(1, core::Impulse{BodyId{1}, {31, 0, 0}, {}});  // 1 kg
  order(1, core::Impulse{BodyId{1}, {0, 0, 1e6}, Vec3(10, 0, 50)});
  order(1, core::Impulse{BodyId{1}, {29, 0, 0}, {}});
  world.step();
  EXPECT_NEAR(world.snapshot().bodies[0].v_WB.x(), 29, 0.1);
  const std::vector<Declined> declined = world.take_declined();
  ASSERT_EQ(declined.size(), 2u);
  EXPECT_EQ(declined[0].request, 11u);
  EXPECT_NE(declined[0].why.find("tolerances.speed"), std::string::npos) << declined[0].why;
  EXPECT_EQ(world.take_applied(), std::vector<std::uint64_t>{13});
}

/// Off the centre of mass: no faster, but it would spin beyond what a substep can turn.
TEST_F(Breakdown, ASpinBeyondAQuarterTurnInASubstepIsDeclined) {
  place(1, {0, 0, 50});
  order(1, core::Impulse{BodyId{1}, {0, 20, 0}, Vec3(100, 0, 50)});
  order(1, core::SetVelocity{BodyId{1}, {0, 0, 0}, Vec3(1e6, 1e6, 1e6)});
  world.step();
  EXPECT_LT(world.snapshot().bodies[0].w_WB.norm(), 1e-3);
  ASSERT_EQ(world.take_declined().size(), 2u);
}

TEST_F(Breakdown, WhoIsTooFastAlreadyMayBeSlowedDown) {
  place(1, {0, 0, 50}, {100, 0, 0});
  order(1, core::Impulse{BodyId{1}, {-20, 0, 0}, {}});
  order(1, core::Impulse{BodyId{1}, {20.5, 0, 0}, {}});
  world.step();
  EXPECT_NEAR(world.snapshot().bodies[0].v_WB.x(), 100.5 - 20.5 + 20.5 - 20, 1);
  EXPECT_EQ(world.take_declined().size(), 1u);
}

}  // namespace
}  // namespace aurasim::physics::testing
