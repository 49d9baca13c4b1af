// A message that was refused never comes again as anything better: nobody waits for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/intake_fixture.h"

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class RefusedMessage : public IntakeTest {
 protected:
  void refuse(std::uint32_t from, Step stamp, Generation generation) {
    inbox.refusals.push_back({region(from), generation, stamp, MessageKind::kAura, "not_finite"});
    intake->accept(inbox);
  }
  void refuse(std::uint32_t from, Step stamp) { refuse(from, stamp, settings.generation); }
};

TEST_F(RefusedMessage, ItsSourceIsNotWaitedForAnyMore) {
  receive_until(2, 9);
  receive_until(1, 4);
  refuse(1, 5);
  EXPECT_TRUE(intake->ready(8));
  EXPECT_THAT(intake->missing(8), IsEmpty());
}

TEST_F(RefusedMessage, ItsSourceIsHeldForDead) {
  refuse(1, 0);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(1)));
}

TEST_F(RefusedMessage, IsNamed) {
  refuse(1, 5);
  ASSERT_EQ(intake->refusals().size(), 1u);
  EXPECT_EQ(intake->refusals()[0].source, region(1));
  EXPECT_EQ(intake->refusals()[0].stamp, 5);
  EXPECT_EQ(intake->refusals()[0].why, "not_finite");
}

TEST_F(RefusedMessage, OfTheDeadIsNoNews) {
  lose(1);
  refuse(1, 5);
  EXPECT_THAT(intake->refusals(), IsEmpty());
}

TEST_F(RefusedMessage, OfAnEarlierGenerationIsNobodysDeath) {
  refuse(1, 5, settings.generation - 1);
  EXPECT_THAT(intake->dead_regions(), IsEmpty());
}

TEST_F(RefusedMessage, OfTheNextGenerationWaitsForIt) {
  refuse(1, 0, settings.generation + 1);
  EXPECT_THAT(intake->dead_regions(), IsEmpty());
  ASSERT_EQ(inbox.refusals.size(), 1u);
  ++settings.generation;
  listen(SyncMode::kBounded, 2);
  intake->accept(inbox);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(1)));
}

/// Nothing between has come, and nothing will: the transport delivers in order.
TEST_F(RefusedMessage, IsABatchOrAHandOffFromFarAhead) {
  receive_until(1, 4);
  receive(batch(1, 4 + 4096));
  EXPECT_THAT(intake->dead_regions(), IsEmpty());
  receive(batch(1, 4 + 4097));
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(1)));
  receive(hand_off(2, 0, 1'000'000, {record_of(7, 1)}), 1);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(1), region(2)));
  EXPECT_EQ(intake->refusals().back().why, "far ahead");
}

TEST_F(RefusedMessage, OfLaterGenerationsOnlySoManyWait) {
  for (int i = 0; i < 10'100; ++i) {
    AuraBatch later = ours(batch(1, i));
    ++later.generation;
    inbox.auras.push_back(later);
  }
  intake->accept(inbox);
  EXPECT_EQ(inbox.auras.size(), 10'000u);
}

TEST_F(RefusedMessage, InFreeRunningToo) {
  listen(SyncMode::kFreeRunning, 2);
  refuse(1, 5);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(1)));
}

}  // namespace
}  // namespace aurasim::core::testing
