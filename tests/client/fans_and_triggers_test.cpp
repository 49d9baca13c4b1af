// Sensors that look at a state.
#include "agent/fans_and_triggers.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::agent {
namespace {

using core::BodyId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

WorldBody body(std::uint64_t id, const core::Vec3& p_WB) {
  WorldBody made;
  made.row.id = BodyId{id};
  made.row.p_WB = p_WB;
  return made;
}

TEST(ATrigger, SaysWhoIsInWhoHasComeAndWhoHasGone) {
  Trigger trigger({.mount = {{}, {{10, 0, 0}, core::Quat::Identity()}}, .half_extents = {1, 2, 3}});
  TriggerResult result = trigger.look({body(1, {10.9, 1.9, -2.9}), body(2, {11.1, 0, 0}), body(3, {9, 2, 3})});
  EXPECT_THAT(result.inside, ElementsAre(BodyId{1}, BodyId{3}));
  EXPECT_THAT(result.entered, ElementsAre(BodyId{1}, BodyId{3}));
  result = trigger.look({body(1, {12, 0, 0}), body(2, {10, 0, 0}), body(3, {9, 2, 3})});
  EXPECT_THAT(result.inside, ElementsAre(BodyId{2}, BodyId{3}));
  EXPECT_THAT(result.entered, ElementsAre(BodyId{2}));
  EXPECT_THAT(result.left, ElementsAre(BodyId{1}));
}

TEST(ATrigger, IsTurnedWithItsCarrierAndDoesNotSeeIt) {
  Trigger trigger({.mount = {BodyId{1}, {{2, 0, 0}, core::Quat::Identity()}}, .half_extents = {1, 0.1, 0.1}});
  WorldBody carrier = body(1, {5, 5, 0});
  carrier.row.q_WB = Eigen::Quaternionf(Eigen::AngleAxisf(std::numbers::pi_v<float> / 2, Eigen::Vector3f::UnitZ()));
  EXPECT_THAT(trigger.look({carrier, body(2, {5, 7.5, 0}), body(3, {7, 5, 0})}).inside, ElementsAre(BodyId{2}));
  const TriggerResult without = trigger.look({body(2, {5, 7.5, 0})});
  EXPECT_FALSE(without.complete);
  EXPECT_THAT(without.inside, IsEmpty());
}

TEST(ATrigger, MayBeABall) {
  Trigger trigger({.mount = {}, .radius_m = 2});
  EXPECT_THAT(trigger.look({body(1, {1.9, 0, 0}), body(2, {1.5, 1.5, 0})}).inside, ElementsAre(BodyId{1}));
}

TEST(Surroundings, OfAFixedSensorStay) {
  Surroundings around({{}, {{1, 2, 3}, core::Quat::Identity()}}, 5);
  ASSERT_TRUE(around.box());
  around.note(1);
  EXPECT_FALSE(around.follow({1, 2, 3}, 5));
  EXPECT_TRUE(around.was_asked_for(1, {1, 2, 3}));
  EXPECT_FALSE(around.was_asked_for(2, {1, 2, 3}));
  EXPECT_TRUE(around.follow({1, 2, 3}, 6)) << "something larger may be about";
  around.note(2);
  EXPECT_TRUE(around.was_asked_for(2, {1, 2, 3}));
}

TEST(Surroundings, FollowTheirCarrierNowAndThen) {
  Surroundings around({BodyId{4}, {}}, 8);
  EXPECT_FALSE(around.box());
  EXPECT_TRUE(around.follow({0, 0, 0}, 8));
  around.note(1);
  EXPECT_FALSE(around.follow({0.9, 0, 0}, 8));
  EXPECT_TRUE(around.was_asked_for(1, {1.9, 0, 0}));
  EXPECT_FALSE(around.was_asked_for(1, {2.1, 0, 0}));
  EXPECT_TRUE(around.follow({1.1, 0, 0}, 8));
  around.note(2);
  EXPECT_TRUE(around.was_asked_for(2, {2.1, 0, 0}));
  EXPECT_TRUE(around.was_asked_for(1, {1.9, 0, 0})) << "what was asked for before is not forgotten";
}

}  // namespace
}  // namespace aurasim::agent
