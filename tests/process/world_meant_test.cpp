// What comes of a run command that is heard before, while or after the world that it is for begins.
#include "process/world_meant.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

TEST(WorldMeant, ThatWhichTheNodeComputes) {
  EXPECT_EQ(world_meant(3, {.begun = 3}), WorldMeant::kPresent);
  EXPECT_EQ(world_meant(3, {.begun = 3, .restored = 3}), WorldMeant::kPresent);
  EXPECT_EQ(world_meant(3, {.begun = 3, .reset_to = 4}), WorldMeant::kPresent);
}

TEST(WorldMeant, ThatWhichWaitsForItsStartHasNotBegun) {
  EXPECT_EQ(world_meant(0, {.waits_for = 0}), WorldMeant::kNext) << "before the first state";
  EXPECT_EQ(world_meant(4, {.begun = 3, .waits_for = 4}), WorldMeant::kNext) << "scene or regions change";
  EXPECT_EQ(world_meant(4, {.begun = 3, .waits_for = 4, .restored = 4}), WorldMeant::kNext) << "a recovery";
  EXPECT_EQ(world_meant(4, {.waits_for = 4, .restored = 4}), WorldMeant::kNext) << "whoever takes a region over";
}

TEST(WorldMeant, ThatOfARestoreIsKnownBeforeItWaitsForItsStart) {
  EXPECT_EQ(world_meant(4, {.begun = 3, .restored = 4}), WorldMeant::kNext);
}

TEST(WorldMeant, ThatAfterAResetIsKnownBeforeItIsDue) {
  EXPECT_EQ(world_meant(4, {.begun = 3, .reset_to = 4}), WorldMeant::kNext);
}

TEST(WorldMeant, WhatAllHaveLeftForARestoreIsPast) {
  EXPECT_EQ(world_meant(3, {.begun = 3, .restored = 4}), WorldMeant::kPast);
  EXPECT_EQ(world_meant(2, {.begun = 4, .restored = 4}), WorldMeant::kPast);
}

TEST(WorldMeant, WhatIsOverIsNeverNext) {
  EXPECT_EQ(world_meant(4, {.begun = 6, .restored = 4}), WorldMeant::kOver);
  EXPECT_EQ(world_meant(2, {.begun = 3}), WorldMeant::kOver);
}

TEST(WorldMeant, OfWhatNobodyHasAnnouncedNothingIsTaken) {
  EXPECT_EQ(world_meant(5, {.begun = 3, .reset_to = 4}), WorldMeant::kOver);
  EXPECT_EQ(world_meant(1, {}), WorldMeant::kOver);
}

}  // namespace
}  // namespace aurasim::process
