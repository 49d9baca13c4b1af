// Which received commands are executed now, which later, and which never.
#include "process/command_queue.h"

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

messages::RunCommand pause_in(core::Generation generation, std::uint64_t request) {
  messages::RunCommand command;
  command.kind = messages::RunCommandKind::kPause;
  command.generation = generation;
  command.request = request;
  return command;
}

TEST(CommandQueue, ACommandForTheWorldThatIsComputedIsForNow) {
  CommandQueue queue;
  EXPECT_FALSE(queue.is_for_now(pause_in(3, 1), {}));
  queue.take_early(3);
  EXPECT_TRUE(queue.is_for_now(pause_in(3, 2), {}));
}

TEST(CommandQueue, ACommandForAWorldToComeWaitsForIt) {
  CommandQueue queue;
  queue.take_early(3);
  Worlds known;
  known.waits_for = 4;
  EXPECT_FALSE(queue.is_for_now(pause_in(4, 1), known));
  EXPECT_FALSE(queue.is_for_now(pause_in(9, 2), known)) << "no such world is known";
  const std::vector<messages::RunCommand> early = queue.take_early(4);
  ASSERT_EQ(early.size(), 1U);
  EXPECT_EQ(early[0].request, 1U);
  EXPECT_TRUE(queue.take_early(4).empty());
  EXPECT_TRUE(queue.is_for_now(pause_in(4, 1), {})) << "it has begun";
}

TEST(CommandQueue, ACommandForAWorldThatAllHaveLeftIsKeptForItsRepetition) {
  CommandQueue queue;
  queue.take_early(3);
  Worlds known;
  known.restored = 5;
  EXPECT_FALSE(queue.is_for_now(pause_in(3, 7), known));
  EXPECT_TRUE(queue.take_early(5).empty());
  const std::vector<messages::RunCommand> late = queue.take_late();
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].request, 7U);
  EXPECT_TRUE(queue.take_late().empty());
}

TEST(CommandQueue, ACommandForAWorldThatIsOverIsDropped) {
  CommandQueue queue;
  queue.take_early(3);
  EXPECT_FALSE(queue.is_for_now(pause_in(2, 1), {}));
  EXPECT_TRUE(queue.take_early(4).empty());
  EXPECT_TRUE(queue.take_late().empty());
}

TEST(CommandQueue, AStateFarAheadIsNotPlausible) {
  CommandQueue queue;
  const CommandQueue::Time now{};
  queue.begin(100, now);
  messages::RunCommand command = pause_in(0, 1);
  command.at_step = 110;
  EXPECT_EQ(queue.problem_with(command, 0, 0), "");
  command.at_step = 1'000'000'000;
  EXPECT_NE(queue.problem_with(command, 0, 0), "");
}

}  // namespace
}  // namespace aurasim::process
