// Who owns a body in the eyes of an observer, rule by rule.
#include "overseer/world_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::overseer {
namespace {

using core::BodyId;
using core::RegionId;
using State = WorldView::RegionState;

core::ReplicaBody body(std::uint64_t id, std::uint32_t host, core::Epoch epoch, double x = 0) {
  core::ReplicaBody row;
  row.id = BodyId{id};
  row.host = RegionId{host};
  row.epoch = epoch;
  row.p_WB.x() = x;
  return row;
}

class View : public ::testing::Test {
 protected:
  View() {
    for (std::uint32_t r = 0; r < 3; ++r) view_.set_region(RegionId{r}, State::kLive);
  }
  void publish(std::uint32_t source, core::Step stamp, std::vector<core::ReplicaBody> bodies, bool key = false,
               std::vector<core::RemovedBody> removed = {}) {
    core::Replica replica;
    replica.source = RegionId{source};
    replica.generation = generation_;
    replica.stamp = stamp;
    replica.sequence = static_cast<std::uint64_t>(stamp / 3) + 1;
    replica.key_frame = key;
    replica.bodies = std::move(bodies);
    replica.removed = std::move(removed);
    view_.accept(std::move(replica), now_s_);
  }
  /// Regions that have nothing to publish at this tick.
  void quiet(core::Step stamp, std::initializer_list<std::uint32_t> regions) {
    for (const std::uint32_t region : regions) publish(region, stamp, {});
  }
  const WorldFrame* compose() { return view_.compose(now_s_); }
  const ViewBody& seen(std::uint64_t id) {
    const ViewBody* found = view_.find(BodyId{id});
    if (found == nullptr) throw std::runtime_error("no such body");
    return *found;
  }

  WorldView view_{{.region_count = 3, .unclaimed_patience = 30, .wait_s = 0.3}};
  core::Generation generation_ = 0;
  double now_s_ = 0;
};

TEST_F(View, AFrameIsComposedOnceEveryLiveRegionHasToldItsTick) {
  publish(0, 3, {body(1, 0, 0)});
  publish(1, 3, {body(2, 1, 0)});
  EXPECT_EQ(compose(), nullptr);
  publish(2, 3, {});
  const WorldFrame* frame = compose();
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->stamp, 3);
  EXPECT_TRUE(frame->restart);
  EXPECT_EQ(frame->changed.size(), 2U);
  EXPECT_EQ(compose(), nullptr);
}

TEST_F(View, ARegionAheadOfTheOthersIsShownWhenTheyAreThere) {
  publish(0, 3, {body(1, 0, 0, 0.1)});
  publish(0, 6, {body(1, 0, 0, 0.2)});
  quiet(3, {1, 2});
  ASSERT_EQ(compose()->stamp, 3);
  EXPECT_EQ(seen(1).p_WB.x(), 0.1);
  quiet(6, {1, 2});
  ASSERT_EQ(compose()->stamp, 6);
  EXPECT_EQ(seen(1).p_WB.x(), 0.2);
}

TEST_F(View, ASlowRegionIsNotWaitedForForEver) {
  publish(0, 3, {body(1, 0, 0)});
  now_s_ = 0.31;
  ASSERT_NE(compose(), nullptr);
  EXPECT_EQ(view_.counters().incomplete, 1U);
}

TEST_F(View, ARegionThatIsNotThereIsNotWaitedFor) {
  view_.set_region(RegionId{1}, State::kAbsent);
  view_.set_region(RegionId{2}, State::kDead);
  publish(0, 3, {body(1, 0, 0)});
  EXPECT_NE(compose(), nullptr);
}

TEST_F(View, ABodyOnItsWayKeepsItsLastPoseUntilItsNewHostTellsOfIt) {
  publish(0, 3, {body(1, 0, 0, 1.0)});
  quiet(3, {1, 2});
  compose();
  publish(0, 6, {body(1, 2, 1, 1.5)});
  quiet(6, {1, 2});
  ASSERT_EQ(compose()->changed.size(), 1U);
  EXPECT_TRUE(seen(1).under_way);
  EXPECT_EQ(seen(1).host, RegionId{2});
  EXPECT_EQ(seen(1).p_WB.x(), 1.5);
  quiet(9, {0, 1});
  publish(2, 9, {body(1, 2, 1, 2.0)});
  const WorldFrame* frame = compose();
  ASSERT_EQ(frame->changed.size(), 1U);
  EXPECT_TRUE(frame->changed[0].handed_over);
  EXPECT_FALSE(seen(1).under_way);
  EXPECT_EQ(seen(1).p_WB.x(), 2.0);
}

TEST_F(View, TheOrderInWhichTwoRegionsTellOfAHandOffDoesNotMatter) {
  publish(2, 3, {body(1, 2, 1, 2.0)});
  quiet(3, {0, 1});
  compose();
  publish(0, 6, {body(1, 2, 1, 1.5)});
  quiet(6, {1, 2});
  compose();
  EXPECT_FALSE(seen(1).under_way);
  EXPECT_EQ(seen(1).p_WB.x(), 2.0);
}

TEST_F(View, TheHighestEpochOwns) {
  publish(0, 3, {body(1, 0, 5, 5)});
  publish(1, 3, {body(1, 1, 4, 4)});
  publish(2, 3, {body(1, 2, 3, 3)});
  compose();
  EXPECT_EQ(view_.body_count(), 1U);
  EXPECT_EQ(seen(1).host, RegionId{0});
  EXPECT_EQ(view_.counters().stale, 2U);
}

TEST_F(View, ARemovedBodyIsGoneAndAnOlderWordDoesNotBringItBack) {
  publish(0, 3, {body(1, 0, 2)});
  quiet(3, {1, 2});
  compose();
  publish(0, 6, {}, false, {{BodyId{1}, 2}});
  publish(1, 6, {body(1, 0, 2)});  // its sender, late
  quiet(6, {2});
  EXPECT_EQ(compose()->deleted.size(), 1U);
  EXPECT_EQ(view_.body_count(), 0U);
}

TEST_F(View, ARemovalDoesNotTouchACopyWithAHigherEpoch) {
  publish(0, 3, {body(1, 0, 2)});
  publish(1, 3, {body(1, 1, 3)});
  publish(2, 3, {});
  compose();
  publish(0, 6, {}, false, {{BodyId{1}, 2}});
  quiet(6, {1, 2});
  compose();
  EXPECT_EQ(seen(1).host, RegionId{1});
}

TEST_F(View, AKeyFrameBringsWhatWasMissedAndItsSilenceIsDoubt) {
  publish(0, 3, {body(1, 0, 0), body(2, 0, 0)});
  quiet(3, {1, 2});
  compose();
  publish(0, 6, {body(2, 0, 0, 7), body(3, 0, 0)}, true);
  quiet(6, {0, 1, 2});
  compose();
  EXPECT_EQ(seen(2).p_WB.x(), 7);
  EXPECT_EQ(view_.body_count(), 3U) << "for a while";
  quiet(36, {0, 1, 2});
  compose();
  EXPECT_EQ(view_.body_count(), 2U);
  EXPECT_EQ(view_.find(BodyId{1}), nullptr);
  EXPECT_EQ(view_.counters().given_up, 1U);
}

/// A key frame that has come is no part of what is seen before its tick has been composed.
TEST_F(View, ARegionIsWholeOnceItsKeyFrameIsInAFrame) {
  publish(0, 3, {body(1, 0, 0)}, true);
  publish(0, 3, {});
  publish(1, 3, {body(2, 1, 0)}, true);
  EXPECT_EQ(compose(), nullptr);
  EXPECT_FALSE(view_.is_whole(RegionId{0}));
  quiet(3, {1, 2});
  ASSERT_NE(compose(), nullptr);
  EXPECT_TRUE(view_.is_whole(RegionId{0}));
  EXPECT_TRUE(view_.is_whole(RegionId{1}));
  EXPECT_FALSE(view_.is_whole(RegionId{2}));
  EXPECT_EQ(view_.body_count(), 2u);
  ++generation_;
  publish(0, 3, {});
  EXPECT_FALSE(view_.is_whole(RegionId{0}));
}

TEST_F(View, AnOldKeyFrameDoesNotUndoWhatIsKnownBetter) {
  publish(0, 9, {body(1, 0, 0, 9), body(2, 0, 0, 9)});
  quiet(9, {1, 2});
  compose();
  publish(0, 6, {body(1, 0, 0, 6)}, true);
  compose();
  EXPECT_EQ(seen(1).p_WB.x(), 9);
  quiet(60, {0, 1, 2});
  compose();
  EXPECT_EQ(view_.body_count(), 2U);
}

TEST_F(View, WhatADeadRegionHostedIsGoneUnlessOthersClaimIt) {
  publish(0, 3, {body(1, 0, 0), body(2, 0, 0)});
  quiet(3, {1, 2});
  compose();
  view_.set_region(RegionId{0}, State::kDead);
  quiet(6, {1, 2});
  compose();
  EXPECT_EQ(view_.body_count(), 2U);
  publish(1, 9, {body(2, 1, 1)});
  quiet(9, {2});
  compose();
  quiet(60, {1, 2});
  compose();
  EXPECT_EQ(view_.body_count(), 1U);
  EXPECT_EQ(seen(2).host, RegionId{1});
}

TEST_F(View, ANewGenerationBeginsAnew) {
  publish(0, 30, {body(1, 0, 0)});
  quiet(30, {1, 2});
  compose();
  generation_ = 1;
  publish(0, 0, {body(5, 0, 0)});
  generation_ = 0;
  publish(1, 33, {body(6, 1, 0)});  // of the old world, late
  generation_ = 1;
  quiet(0, {1, 2});
  const WorldFrame* frame = compose();
  ASSERT_NE(frame, nullptr);
  EXPECT_TRUE(frame->restart);
  EXPECT_EQ(frame->generation, 1U);
  EXPECT_EQ(frame->stamp, 0);
  EXPECT_EQ(view_.body_count(), 1U);
}

TEST_F(View, GapsAreCounted) {
  publish(0, 3, {});
  publish(0, 12, {});
  quiet(12, {1, 2});
  while (compose() != nullptr) {
  }
  EXPECT_EQ(view_.counters().gaps, 2U);
}

}  // namespace
}  // namespace aurasim::overseer
