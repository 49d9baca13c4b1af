// A touch of two bodies that were in two worlds is found, whoever hosts them; whatever was in one world is no news.
#include "core/state_check.h"

#include <memory>
#include <optional>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/aura_precision.h"
#include "core/interest_matching.h"
#include "core/letters.h"
#include "core/make_aura.h"
#include "core/round_shapes.h"

namespace aurasim::core::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

AuraRules rules_of_check() {
  AuraRules rules;
  rules.redo = true;
  rules.substeps = 4;
  rules.gravity = Vec3::Zero();
  return rules;
}

/// We are the left of three columns; body 1 is ours and stands at the border, the others are of region 1.
class TheCheck : public ::testing::Test {
 protected:
  void publish(Step stamp, std::vector<AuraRecord> updates, std::uint32_t source = 1) {
    AuraBatch sent = batch(source, stamp);
    sent.full = stamp == 0;
    sent.updates = std::move(updates);
    neighbours_.at(source - 1).accept(std::move(sent), [this](const Neighbour& now) { check_->take(now); });
  }
  AuraRecord body(std::uint64_t id, Step stamp, const Vec3& p, const Vec3& v = Vec3::Zero()) const {
    AuraRecord record;
    record.id = BodyId{id};
    record.host = RegionId{1};
    record.prototype = ball_;
    record.stamp = stamp;
    record.pose.p_WB = p;
    record.v_WB = v;
    return record;
  }
  std::span<const Alarm> look(Step step) {
    Snapshot own;
    own.step = step;
    BodyState& ours = own.bodies.emplace_back();
    ours.id = BodyId{1};
    ours.prototype = ball_;
    ours.pose.p_WB = ours_at_;
    matching_.look(own, {}, {});
    check_->take_own(own, matching_);
    check_->look(step, neighbours_);
    return check_->found();
  }

  /// What the check of states 0 and 1 finds where region 1 hosts body 2 at `a`, and region 2 hosts body 3 at `b`.
  std::vector<Alarm> touch_of_two(const Vec3& a, const Vec3& b) {
    neighbours_ = {Neighbour(region(1), region(0)), Neighbour(region(2), region(0))};
    check_.emplace(*aura_, vicinity_, 0);
    ours_at_ = {-8, 0, 0};
    for (Step step = 0; step < 2; ++step) {
      publish(step, {body(2, step, a)});
      publish(step, {body(3, step, b)}, 2);
      look(step + 1);
    }
    return {check_->found().begin(), check_->found().end()};
  }

  Vec3 ours_at_{-0.2, 0, 0};
  RoundShapes shapes_;
  PrototypeId ball_ = shapes_.sphere(0.5);
  RegionMap map_ = RegionMap::boxes({{-10, -5, 0, 5}, {0, -5, 10, 5}, {10, -5, 20, 5}});
  Vicinity vicinity_{map_, RegionId{0}, 0};
  std::unique_ptr<const Aura> aura_ = make_aura(rules_of_check(), shapes_);
  InterestMatching matching_{*aura_, vicinity_};
  std::optional<StateCheck> check_{std::in_place, *aura_, vicinity_, 0};
  std::vector<Neighbour> neighbours_ = {Neighbour(region(1), region(0))};
};

TEST_F(TheCheck, FindsNothingBetweenBodiesThatAreApart) {
  for (Step step = 0; step < 4; ++step) {
    publish(step, {body(2, step, {1.2, 0, 0})});
    EXPECT_THAT(look(step + 1), IsEmpty());
  }
  EXPECT_EQ(check_->checked(), 3) << "a state later, for K = 1";
}

TEST_F(TheCheck, FindsATouchInTheStateAfterTheOneInWhichTheyAreThatNear) {
  publish(0, {body(2, 0, {0.81, 0, 0})});
  look(0);
  look(1);
  publish(1, {body(2, 1, {0.81, 0, 0})});
  const auto found = look(2);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].a, BodyId{1});
  EXPECT_EQ(found[0].b, BodyId{2});
  EXPECT_EQ(found[0].step, 1);
}

/// Two that just touch, one of which is where its aura says only to within rounding.
TEST_F(TheCheck, FindsATouchWithABodyWhosePlaceTravelsRounded) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> any;
  for (int i = 0; i < 100; ++i) {
    const Vec3 way = Vec3(any(random), any(random), any(random)).normalized();
    const Vec3 place = ours_at_ + (1 + aura_->rules().contact_margin_m - 1e-6) * way;
    const Vec3 rounded = (place / kPositionGrain_m).array().round() * kPositionGrain_m;
    neighbours_ = {Neighbour(region(1), region(0))};
    check_.emplace(*aura_, vicinity_, 0);
    publish(0, {body(2, 0, rounded)});
    look(0);
    look(1);
    publish(1, {body(2, 1, rounded)});
    EXPECT_THAT(look(2), SizeIs(1)) << "at " << place.transpose();
  }
}

TEST_F(TheCheck, FindsATouchWithABodyOfOursThatWasNotAnnounced) {
  ours_at_ = {-8, 0, 0};
  look(0);
  EXPECT_EQ(matching_.audience(0), kNobodyListens);
  publish(0, {body(2, 0, {-6.99, 0, 0})});
  look(1);
  publish(1, {body(2, 1, {-6.99, 0, 0})});
  EXPECT_THAT(look(2), SizeIs(1));
}

TEST_F(TheCheck, LooksAtTheSubstepsInBetween) {
  look(0);
  publish(0, {body(2, 0, {-1.8, 1.4, 0}, {192, 0, 0})});
  look(1);
  publish(1, {body(2, 1, {1.4, 1.4, 0}, {192, 0, 0})});
  EXPECT_THAT(look(2), IsEmpty()) << "past it";
  publish(2, {body(2, 2, {1.4, 0, 0}, {-192, 0, 0})});
  look(3);
  publish(3, {body(2, 3, {-1.8, 0, 0}, {-192, 0, 0})});
  EXPECT_THAT(look(4), SizeIs(1)) << "through the place of ours, near it at neither end";
}

TEST_F(TheCheck, SaysNothingOfTwoThatOneNeighbourHosts) {
  for (Step step = 0; step < 3; ++step) {
    publish(step, {body(2, step, {1.2, 0, 0}), body(3, step, {1.3, 0, 0})});
    EXPECT_THAT(look(step + 1), IsEmpty());
  }
}

/// Hosts announce a body outside their region to the owner of its place, and not to all others who host bodies there.
TEST_F(TheCheck, FindsATouchOfTwoThatTwoNeighboursHostOverOurRegion) {
  const auto found = touch_of_two({-4, 0, 0}, {-3.1, 0, 0});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].a, BodyId{2});
  EXPECT_EQ(found[0].b, BodyId{3});
}

/// Its host compares it with all that is near it.
TEST_F(TheCheck, LeavesABodyThatIsAtHomeToItsHost) {
  EXPECT_THAT(touch_of_two({4, 0, 0}, {4.9, 0, 0}), IsEmpty());
  EXPECT_THAT(touch_of_two({12, 0, 0}, {12.9, 0, 0}), IsEmpty());
}

TEST_F(TheCheck, KnowsThatABodyTouchesNothingBeforeTheStateAfterItsBirth) {
  constexpr Step kBirth = 2;
  look(0);
  for (Step step = 0; step < 4; ++step) {
    AuraRecord newborn = body(2, step, {0.7, 0, 0});
    newborn.birth = step < kBirth ? kBirth : 0;  // as after the wire
    publish(step, {newborn});
    EXPECT_THAT(look(step + 1), SizeIs(step <= kBirth ? 0 : 1)) << "state " << step;
  }
}

TEST_F(TheCheck, TakesABodyThatMadeUpAStateAloneForOneInAnotherWorld) {
  BodyState late;
  late.id = BodyId{4};
  late.prototype = ball_;
  late.pose.p_WB = {0.7, 0, 0};
  look(0);
  publish(0, {});
  look(1);
  check_->take_made_up(late, 0, 0);
  check_->take_made_up(late, 1, 0);
  publish(1, {});
  EXPECT_THAT(look(2), SizeIs(1));
}

TEST_F(TheCheck, TakesClustersThatMadeUpAStateForSeveralWorldsWheneverTheyJoin) {
  BodyState one, other;
  one.id = BodyId{4}, other.id = BodyId{5};
  one.prototype = other.prototype = ball_;
  one.pose.p_WB = {50, 0, 0}, other.pose.p_WB = {50.7, 0, 0};
  look(0);
  publish(0, {});
  look(1);
  for (const Step step : {0, 1}) check_->take_made_up(one, step, 0);
  for (const Step step : {0, 1}) check_->take_made_up(other, step, 1);
  publish(1, {});
  EXPECT_THAT(look(2), SizeIs(1));
}

}  // namespace
}  // namespace aurasim::core::testing
