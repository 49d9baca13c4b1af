#include "core/order_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Order order(std::uint64_t sequence) { return {sequence, 100 + sequence, 50, RemoveBody{BodyId{sequence}}}; }

std::vector<std::uint64_t> sequences(const std::vector<Order>& orders) {
  std::vector<std::uint64_t> list;
  for (const Order& o : orders) list.push_back(o.sequence);
  return list;
}

TEST(OrderLog, OurOwnOrdersAreNumberedFromOne) {
  OrderLog log;
  EXPECT_EQ(log.announce(order(0), 0).sequence, 1u);
  EXPECT_EQ(log.announce(order(0), 0).sequence, 2u);
  EXPECT_EQ(log.last(), 2u);
}

TEST(OrderLog, NewsAreGivenOutOnce) {
  OrderLog log;
  log.announce(order(0), 0);
  log.receive(std::vector{order(2), order(3)}, 0);
  EXPECT_THAT(sequences(log.take_news()), ElementsAre(1, 2, 3));
  EXPECT_THAT(log.take_news(), IsEmpty());
}

TEST(OrderLog, EachOrderIsPassedOnOnce) {
  OrderLog log;
  log.receive(std::vector{order(1)}, 0);
  EXPECT_THAT(sequences(log.take_to_publish()), ElementsAre(1));
  log.receive(std::vector{order(1)}, 0);  // from another neighbour
  EXPECT_THAT(log.take_to_publish(), IsEmpty());
}

/// Several neighbours say the same orders; whoever is ahead is heard first.
TEST(OrderLog, CopiesAreLeftOutAndLaterOnesGoOn) {
  OrderLog log;
  log.receive(std::vector{order(1), order(2), order(1), order(2), order(3)}, 0);
  EXPECT_THAT(sequences(log.take_news()), ElementsAre(1, 2, 3));
}

TEST(OrderLog, NobodyKnowsAnOrderButNotTheOneBefore) {
  OrderLog log;
  log.receive(std::vector{order(2), order(3)}, 0);
  EXPECT_THAT(log.take_news(), IsEmpty());
  log.receive(std::vector{order(1), order(2)}, 0);
  EXPECT_THAT(sequences(log.take_news()), ElementsAre(1, 2));
  EXPECT_EQ(log.last(), 2u);
}

TEST(OrderLog, GoesOnAfterTheOrdersOfAnEarlierMap) {
  OrderLog log(7);
  log.receive(std::vector{order(7), order(8)}, 0);
  EXPECT_THAT(sequences(log.take_news()), ElementsAre(8));
  EXPECT_EQ(log.announce(order(0), 0).sequence, 9u);
}

}  // namespace
}  // namespace aurasim::core::testing
