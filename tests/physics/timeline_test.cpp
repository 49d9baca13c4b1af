#include "physics/timeline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::physics {
namespace {

using core::BodyId;
using core::StaticId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class TimelineTest : public ::testing::Test {
 protected:
  void order(core::Step at_step, const core::Action& action) { timeline.add({++sequence, sequence, at_step, action}); }
  void kick(core::Step at_step) { order(at_step, core::Impulse{BodyId{7}, {1, 0, 0}, {}}); }
  static std::vector<std::uint64_t> sequences(std::span<const core::Order> orders) {
    std::vector<std::uint64_t> list;
    for (const core::Order& o : orders) list.push_back(o.sequence);
    return list;
  }
  void come(std::uint32_t index, core::Step at_step) { order(at_step, core::AddStatic{StaticId{index}, 0, {}}); }
  void go(std::uint32_t index, core::Step at_step) { order(at_step, core::RemoveStatic{StaticId{index}}); }

  Timeline timeline;
  std::uint64_t sequence = 0;
};

TEST_F(TimelineTest, OrdersAreDueInTheirStateInSequence) {
  kick(9);
  kick(5);
  kick(9);
  EXPECT_THAT(sequences(timeline.due(4)), IsEmpty());
  EXPECT_THAT(sequences(timeline.due(5)), ElementsAre(2));
  EXPECT_THAT(sequences(timeline.due(9)), ElementsAre(1, 3));
}

TEST_F(TimelineTest, WhatIsDueLaterIsComing) {
  kick(5);
  kick(9);
  EXPECT_THAT(sequences(timeline.coming(4)), ElementsAre(1, 2));
  EXPECT_THAT(sequences(timeline.coming(5)), ElementsAre(2));
  EXPECT_THAT(sequences(timeline.coming(9)), IsEmpty());
}

TEST_F(TimelineTest, OrdersThatAreNoBodysAreNothingToPhysics) {
  order(5, core::DefinePrototype{0, 1});
  order(5, core::ChangeScene{"tower"});
  order(5, core::Spawn{BodyId{8}, core::PrototypeId{0}, {}, {0, 0, 0}, {0, 0, 0}});
  EXPECT_THAT(sequences(timeline.due(5)), IsEmpty());
}

TEST_F(TimelineTest, AStaticGoesWhereItIsSentAndStaysThere) {
  const core::Pose home{{1, 0, 0}, core::Quat::Identity()}, away{{5, 0, 0}, core::Quat::Identity()};
  core::StaticBody body;
  body.pose = home;
  order(101, core::MoveStatic{StaticId{3}, home, away, 4});
  order(201, core::MoveStatic{StaticId{3}, away, home, 1});
  const auto x = [&](core::Step step) { return timeline.moves().pose(body, StaticId{3}, step, 1.0 / 60).p_WB.x(); };
  EXPECT_EQ(x(100), 1);
  EXPECT_EQ(x(101), 2);
  EXPECT_EQ(x(104), 5);
  EXPECT_EQ(x(200), 5);
  EXPECT_EQ(x(201), 1);
  EXPECT_EQ(timeline.moves().newest(StaticId{3}), 201);
  EXPECT_EQ(timeline.moves().newest(StaticId{4}), 0);
  timeline.forget_before(150);
  EXPECT_EQ(x(150), 5);
  EXPECT_EQ(x(300), 1);
}

TEST_F(TimelineTest, MovesThatOthersHaveReplacedNeedNotBeKnown) {
  const core::MoveStatic gate{StaticId{1}, {}, {}, 1}, lift{StaticId{2}, {}, {}, 1};
  std::vector<core::Order> orders = {{1, 1, 10, gate},
                                     {2, 2, 20, gate},
                                     {3, 3, 20, lift},
                                     {4, 4, 30, gate},
                                     {5, 5, 5, core::AddStatic{StaticId{9}, 0, {}}}};
  core::forget_moves_before(25, orders);
  EXPECT_THAT(sequences(orders), ElementsAre(2, 3, 4, 5));
}

TEST_F(TimelineTest, AStaticOfTheSceneStandsForEver) {
  EXPECT_TRUE(timeline.stands(0, 0));
  EXPECT_TRUE(timeline.stands(3, 1'000'000));
  EXPECT_FALSE(timeline.statics_change());
}

TEST_F(TimelineTest, AStaticStandsFromItsStateUntilItsEnd) {
  come(2, 5);
  go(2, 9);
  EXPECT_TRUE(timeline.statics_change());
  EXPECT_FALSE(timeline.stands(2, 4));
  EXPECT_TRUE(timeline.stands(2, 5));
  EXPECT_TRUE(timeline.stands(2, 8));
  EXPECT_FALSE(timeline.stands(2, 9));
  EXPECT_TRUE(timeline.stands(1, 4)) << "another";
}

TEST_F(TimelineTest, TheFirstRemovalOfAStaticCounts) {
  go(0, 9);
  go(0, 7);
  go(0, 12);
  EXPECT_TRUE(timeline.stands(0, 6));
  EXPECT_FALSE(timeline.stands(0, 7));
}

TEST_F(TimelineTest, StaticsThatComeOrGoLaterAreAnnounced) {
  come(4, 5);
  go(1, 8);
  EXPECT_THAT(timeline.statics_coming(4), ElementsAre(1, 4));
  EXPECT_THAT(timeline.statics_coming(5), ElementsAre(1));
  EXPECT_THAT(timeline.statics_coming(8), IsEmpty());
}

TEST_F(TimelineTest, WhatIsForgottenIsObeyedNoMore) {
  kick(5);
  kick(9);
  timeline.forget_before(9);
  EXPECT_THAT(sequences(timeline.due(5)), IsEmpty());
  EXPECT_THAT(sequences(timeline.due(9)), ElementsAre(2));
}

TEST_F(TimelineTest, StaticsAreNotForgotten) {
  go(0, 5);
  timeline.forget_before(1000);
  EXPECT_FALSE(timeline.stands(0, 1000));
}

}  // namespace
}  // namespace aurasim::physics
