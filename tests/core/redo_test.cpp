// Alarms go round once, outlive a redo as long as their state has not been computed again, and no longer.
#include "core/redo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/order_log.h"

namespace aurasim::core::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr BodyId kA{3};
constexpr BodyId kB{9};

TEST(AlarmLog, PassesEachPairOnOnce) {
  AlarmLog log;
  log.raise(40, kB, kA);
  log.receive(std::vector<Alarm>{{0, 40, kA, kB}, {0, 41, kA, kB}});
  const std::vector<Alarm> published = log.take_to_publish();
  ASSERT_THAT(published, SizeIs(1));
  EXPECT_EQ(published[0].a, kA) << "the smaller first";
  EXPECT_THAT(log.take_to_publish(), IsEmpty());
}

TEST(AlarmLog, TakesTheEarliestOfAPair) {
  AlarmLog log;
  log.raise(40, kA, kB);
  log.take_to_publish();
  log.receive(std::vector<Alarm>{{0, 38, kA, kB}});
  EXPECT_EQ(log.standing()[0].step, 38);
  EXPECT_THAT(log.take_to_publish(), SizeIs(1));
}

TEST(AlarmLog, ForgetsWhatIsComputedAgain) {
  AlarmLog log;
  log.raise(40, kA, kB);
  log.put_back(30);
  EXPECT_EQ(log.redo(), 1u);
  EXPECT_THAT(log.standing(), IsEmpty());
  log.receive(std::vector<Alarm>{{0, 40, kA, kB}});  // still under way
  EXPECT_THAT(log.standing(), IsEmpty());
  log.receive(std::vector<Alarm>{{1, 40, kA, kB}});  // raised anew
  EXPECT_THAT(log.standing(), SizeIs(1));
}

TEST(AlarmLog, KeepsWhatIsOlderThanTheCutAndPassesItOnAgain) {
  AlarmLog log;
  log.raise(25, kA, kB);
  log.take_to_publish();
  log.put_back(30);
  EXPECT_THAT(log.standing(), SizeIs(1));
  EXPECT_THAT(log.take_to_publish(), SizeIs(1));
  log.put_back(0);
  EXPECT_THAT(log.standing(), IsEmpty());
}

TEST(OrderLog, AfterARedoPassesOnWhatMayNotHaveReachedAll) {
  OrderLog log;
  constexpr Step kRound = 5;
  log.announce({0, 1, 50, RemoveBody{kA}}, 10);
  log.announce({0, 2, 90, RemoveBody{kB}}, 20);
  log.take_to_publish();
  log.put_back(10 + 2 * kRound + 1, kRound);
  const std::vector<Order> again = log.take_to_publish();
  ASSERT_THAT(again, SizeIs(1));
  EXPECT_EQ(again[0].sequence, 2u);
  EXPECT_EQ(log.last(), 2u) << "nothing is numbered anew";
}

}  // namespace
}  // namespace aurasim::core::testing
