#include "core/handoff.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/letters.h"
#include "core/random.h"

namespace aurasim::core {

namespace testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Departures : public ::testing::Test {
 protected:
  std::uint64_t send(std::uint32_t to, Step stamp, std::initializer_list<BodyRecord> bodies = {record_of(1, 1)}) {
    return ledger.record(hand_off(0, to, stamp, bodies)).sequence;
  }
  std::vector<std::uint64_t> due(Step now, Step patience) {
    std::vector<HandOff> out;
    ledger.due_again(now, patience, out);
    std::vector<std::uint64_t> sequences;
    for (const HandOff& h : out) sequences.push_back(h.sequence);
    return sequences;
  }

  DepartureLedger ledger;
};

TEST_F(Departures, AreNumberedFromOneForEachDestination) {
  EXPECT_EQ(send(1, 10), 1u);
  EXPECT_EQ(send(2, 10), 1u);
  EXPECT_EQ(send(1, 10), 2u);
  EXPECT_EQ(ledger.last_sequence(region(1)), 2u);
  EXPECT_EQ(ledger.last_sequence(region(2)), 1u);
  EXPECT_EQ(ledger.last_sequence(region(3)), 0u);
}

TEST_F(Departures, AreKeptWithAllTheyCarryUntilAcknowledged) {
  send(1, 10, {record_of(1, 1), record_of(2, 4)});
  send(1, 11, {record_of(3, 1)});
  EXPECT_EQ(open_bodies(ledger), 3u);
  ledger.acknowledge(region(1), 1);
  EXPECT_EQ(open_bodies(ledger), 1u);
  ASSERT_EQ(ledger.open().size(), 1u);
  EXPECT_EQ(ledger.open().front().cluster.bodies.front().id, body(3));
}

TEST_F(Departures, AreAcknowledgedWithAllEarlierOnes) {
  for (Step stamp = 10; stamp < 13; ++stamp) send(1, stamp);
  ledger.acknowledge(region(1), 2);
  ASSERT_EQ(ledger.open().size(), 1u);
  EXPECT_EQ(ledger.open().front().sequence, 3u);
}

TEST_F(Departures, AreNotAcknowledgedByAnotherRegionOrLowerNumber) {
  send(1, 10);
  ledger.acknowledge(region(2), 1);
  ledger.acknowledge(region(1), 0);
  EXPECT_EQ(ledger.open().size(), 1u);
}

TEST_F(Departures, NumbersAreNotUsedAgainAfterAnAcknowledgement) {
  send(1, 10);
  ledger.acknowledge(region(1), 1);
  EXPECT_EQ(send(1, 11), 2u);
}

TEST_F(Departures, AreDueAgainEverySoOftenWhileOpen) {
  send(1, 10);
  send(1, 13);
  EXPECT_THAT(due(10, 5), IsEmpty());
  EXPECT_THAT(due(14, 5), IsEmpty());
  EXPECT_THAT(due(15, 5), ElementsAre(1));
  EXPECT_THAT(due(18, 5), ElementsAre(2));
  EXPECT_THAT(due(20, 5), ElementsAre(1));
  ledger.acknowledge(region(1), 1);
  EXPECT_THAT(due(25, 5), IsEmpty());
}

TEST(Arrivals, TheFirstCopyIsToldFromLaterOnesInAnyOrder) {
  Random random("orders");
  for (int run = 0; run < 200; ++run) {
    std::vector<std::uint64_t> order;
    for (std::uint64_t s = 1; s <= 12; ++s) order.insert(order.end(), 1 + random.below(3), s);
    std::shuffle(order.begin(), order.end(), random.bits());
    ArrivalLedger ledger;
    std::vector<bool> seen(13, false);
    for (const std::uint64_t s : order) {
      ASSERT_EQ(ledger.first_copy(region(1), s), !seen[s]);
      seen[s] = true;
      const auto gap = static_cast<std::uint64_t>(std::find(seen.begin() + 1, seen.end(), false) - seen.begin());
      ASSERT_TRUE(ledger.has_all_up_to(region(1), gap - 1));
      ASSERT_FALSE(ledger.has_all_up_to(region(1), gap));
    }
  }
}

TEST(Arrivals, OfEachSourceAreCountedApart) {
  ArrivalLedger ledger;
  EXPECT_TRUE(ledger.first_copy(region(1), 1));
  EXPECT_TRUE(ledger.first_copy(region(2), 1));
  EXPECT_FALSE(ledger.has_all_up_to(region(3), 1));
  EXPECT_TRUE(ledger.has_all_up_to(region(3), 0));
}

}  // namespace
}  // namespace testing
}  // namespace aurasim::core
