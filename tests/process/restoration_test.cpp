// How far a node is in a recovery.
#include "process/restoration.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using core::RegionId;

messages::RunCommand restore_of(core::Generation generation, std::vector<std::uint64_t> processes = {10, 11}) {
  messages::RunCommand restore;
  restore.kind = messages::RunCommandKind::kRestore;
  restore.generation = generation;
  for (const std::uint64_t process : processes) restore.members.push_back({process, RegionId{0}, true});
  return restore;
}

class RestorationTest : public ::testing::Test {
 protected:
  static constexpr Restoration::Clock::time_point kNow{100s};

  RestoreMeaning meaning(const messages::RunCommand& restore, core::Generation generation) const {
    return restoration_.meaning(restore, RegionId{1}, 11, generation, generation);
  }

  Restoration restoration_;
};

TEST_F(RestorationTest, IsAgreedWithARestoreOfALaterGeneration) {
  EXPECT_FALSE(restoration_.is_agreed(3));
  restoration_.use(restore_of(3));
  EXPECT_FALSE(restoration_.is_agreed(3)) << "that is the world that has died";
  restoration_.use(restore_of(4));
  EXPECT_TRUE(restoration_.is_agreed(3));
}

TEST_F(RestorationTest, ANodeThatDiesOnTheWayBackNeedsAnotherRestore) {
  restoration_.use(restore_of(4));
  restoration_.begin_attempt(3);
  EXPECT_EQ(restoration_.waits_in(), 3U);
  restoration_.go_back();
  EXPECT_EQ(restoration_.newest(3), 4U);
  EXPECT_FALSE(restoration_.computes_in(3)) << "generation 4 is about to begin";
  EXPECT_TRUE(restoration_.own_world(RegionId{1}, 3, {}).is_going_back);
  restoration_.begin_attempt(3);
  EXPECT_EQ(restoration_.waits_in(), 4U);
  EXPECT_FALSE(restoration_.is_agreed(3));
  EXPECT_FALSE(restoration_.own_world(RegionId{1}, 3, {}).is_going_back);
  restoration_.use(restore_of(5));
  EXPECT_TRUE(restoration_.is_agreed(3));
}

TEST_F(RestorationTest, ComputesAgainOnceTheGenerationHasBegun) {
  restoration_.use(restore_of(4));
  restoration_.go_back();
  restoration_.finish();
  EXPECT_TRUE(restoration_.computes_in(4));
  const OwnWorld own = restoration_.own_world(RegionId{1}, 4, {RegionId{2}});
  EXPECT_EQ(own.current, 4U);
  EXPECT_EQ(own.silent, std::vector<RegionId>{RegionId{2}});
  EXPECT_FALSE(own.is_going_back);
  ASSERT_NE(own.restore, nullptr);
  EXPECT_EQ(own.restore->generation, 4U);
}

TEST_F(RestorationTest, ARestoreThatIsKnownMeansNothingMore) {
  EXPECT_EQ(meaning(restore_of(4), 3), RestoreMeaning::kGoBack);
  restoration_.use(restore_of(4));
  EXPECT_EQ(meaning(restore_of(4), 3), RestoreMeaning::kNothing);
  EXPECT_EQ(meaning(restore_of(5), 3), RestoreMeaning::kGoBack);
  EXPECT_EQ(meaning(restore_of(5, {10, 99}), 3), RestoreMeaning::kReplaced);
  restoration_.use(restore_of(6));
  EXPECT_EQ(meaning(restore_of(5, {10, 99}), 3), RestoreMeaning::kLeftOut);
}

TEST_F(RestorationTest, AStopBreaksARecoveryOffOnlyAfterAWhile) {
  restoration_.begin(kNow);
  EXPECT_FALSE(restoration_.is_stopped(kNow + 1h));
  restoration_.note_stop(true);
  EXPECT_TRUE(restoration_.stop_asked());
  EXPECT_FALSE(restoration_.is_stopped(kNow + 5s));
  EXPECT_TRUE(restoration_.is_stopped(kNow + 6s));
  EXPECT_EQ(restoration_.waited(kNow + 6s), 6s);
  restoration_.begin_world();
  EXPECT_FALSE(restoration_.stop_asked()) << "the world runs, and stops in its state";
}

TEST_F(RestorationTest, AStopOfARunningWorldIsNoneOfTheRecovery) {
  restoration_.note_stop(false);
  EXPECT_FALSE(restoration_.stop_asked());
}

TEST_F(RestorationTest, TheSameQuestionIsAskedOnce) {
  EXPECT_TRUE(restoration_.ask("begin again?"));
  EXPECT_FALSE(restoration_.ask("begin again?"));
  EXPECT_EQ(restoration_.question(), "begin again?");
  restoration_.forget_question();
  EXPECT_EQ(restoration_.question(), "");
  EXPECT_TRUE(restoration_.ask("begin again?"));
}

TEST_F(RestorationTest, TheFirstReasonToBreakOffCounts) {
  EXPECT_FALSE(restoration_.is_broken_off());
  EXPECT_TRUE(restoration_.break_off("nobody takes over region 2"));
  EXPECT_FALSE(restoration_.break_off("another reason"));
  EXPECT_EQ(restoration_.why_broken_off(), "nobody takes over region 2");
}

}  // namespace
}  // namespace aurasim::process
