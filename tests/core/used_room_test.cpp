#include "core/used_room.h"

#include <vector>

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

/// How often memory counted as spare in so many steps.
int times_spare(UsedRoom& room, std::size_t used, int steps) {
  int times = 0;
  for (int i = 0; i < steps; ++i) times += room.is_spare(used) ? 1 : 0;
  return times;
}

TEST(UsedRoom, IsSpareOnceAfterABusyTime) {
  UsedRoom room;
  EXPECT_EQ(times_spare(room, 10'000, 3 * UsedRoom::kSteps), 0);
  EXPECT_EQ(times_spare(room, 50, 3 * UsedRoom::kSteps), 1);
}

TEST(UsedRoom, IsNotSpareWhileAQuarterIsUsed) {
  UsedRoom room;
  times_spare(room, 10'000, UsedRoom::kSteps);
  EXPECT_EQ(times_spare(room, 2'500, 3 * UsedRoom::kSteps), 0);
}

TEST(UsedRoom, OneBusyStepNowAndThenKeepsIt) {
  UsedRoom room;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(times_spare(room, 10'000, 1), 0);
    EXPECT_EQ(times_spare(room, 5, UsedRoom::kSteps - 1), 0);
  }
}

TEST(UsedRoom, FewItemsAreNeverSpare) {
  UsedRoom room;
  times_spare(room, UsedRoom::kFew, UsedRoom::kSteps);
  EXPECT_EQ(times_spare(room, 0, 3 * UsedRoom::kSteps), 0);
}

TEST(UsedRoom, FreedListsHaveNoMemory) {
  std::vector<int> one(100);
  std::vector<double> other(100);
  free_memory(one, other);
  EXPECT_EQ(one.capacity() + other.capacity(), 0);
}

}  // namespace
}  // namespace aurasim::core
