#include "node/time_spent.h"

#include <gtest/gtest.h>

namespace aurasim::node {
namespace {

TEST(TimeSpent, HasNoRedoInARunThatOnlyGoesOn) {
  TimeSpent spent;
  for (core::Step step = 1; step <= 4; ++step) spent.add(step, 0.5, false);
  EXPECT_DOUBLE_EQ(spent.all_s(), 2);
  EXPECT_EQ(spent.in_redos_s(), 0);
}

TEST(TimeSpent, OfARedoIsTheWayBackAndTheStatesThatAreComputedAgain) {
  TimeSpent spent;
  for (core::Step step = 1; step <= 4; ++step) spent.add(step, 1, false);
  spent.add(2, 0.25, true);
  for (core::Step step = 3; step <= 6; ++step) spent.add(step, 2, false);
  EXPECT_DOUBLE_EQ(spent.all_s(), 12.25);
  EXPECT_DOUBLE_EQ(spent.in_redos_s(), 4.25) << "states 3 and 4, not 5 and 6";
}

TEST(TimeSpent, CountsStatesOnceForEachTimeThatTheyAreComputedAgain) {
  TimeSpent spent;
  for (int redo = 0; redo < 3; ++redo) {
    spent.add(1, 1, false);
    spent.add(2, 1, false);
    spent.add(0, 0.5, true);
  }
  EXPECT_DOUBLE_EQ(spent.in_redos_s(), 4 + 1.5);
}

}  // namespace
}  // namespace aurasim::node
