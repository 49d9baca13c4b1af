// Who hangs, by signs of life that come over a pipe; in virtual time but for the pipe.
#include "host/heartbeat.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace aurasim::host {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class Watch : public ::testing::Test {
 protected:
  /// The launcher looks every 20 ms; the processes of these numbers show life every `every`.
  void pass(std::chrono::milliseconds time, std::initializer_list<pid_t> alive,
            std::chrono::milliseconds every = 250ms) {
    for (const auto end = now_ + time; now_ < end; now_ += 20ms) {
      watch_.look(now_);
      if (now_ < next_) continue;
      next_ = now_ + every;
      for (const pid_t process : alive) watch_.note(process, now_);
    }
  }
  bool hangs(pid_t process) const { return watch_.silence_of(process, now_).has_value(); }

  LifeWatch watch_;
  LifeWatch::Clock::time_point now_{100s}, next_{100s};
};

TEST_F(Watch, WhoShowsNoLifeForThreeSecondsHangs) {
  pass(5s, {1, 2});
  pass(2500ms, {2});
  EXPECT_FALSE(hangs(1));
  pass(1s, {2});
  EXPECT_TRUE(hangs(1));
  EXPECT_GT(*watch_.silence_of(1, now_), 3s);
  EXPECT_FALSE(hangs(2));
}

TEST_F(Watch, WhoHasNotShownAnyLifeYetIsNotJudged) {
  pass(60s, {2});
  EXPECT_FALSE(hangs(1));
}

TEST_F(Watch, OnABusyMachinePatienceGrowsWithTheOthersGaps) {
  pass(20s, {1, 2}, 2s);
  EXPECT_GE(watch_.patience(), 8s);
  pass(6s, {2}, 2s);
  EXPECT_FALSE(hangs(1)) << "others take 2 s for what takes a quarter";
  pass(10s, {2}, 2s);
  EXPECT_TRUE(hangs(1));
}

TEST_F(Watch, PatienceShrinksAgainWhenTheMachineIsQuiet) {
  pass(20s, {1, 2}, 2s);
  pass(40s, {1, 2});
  pass(4s, {2});
  EXPECT_TRUE(hangs(1));
}

TEST_F(Watch, TimeInWhichTheLauncherStoodStillIsNobodysSilence) {
  pass(5s, {1, 2});
  now_ += 1min;
  pass(40ms, {});
  EXPECT_FALSE(hangs(1));
  pass(4s, {2});
  EXPECT_TRUE(hangs(1));
  EXPECT_FALSE(hangs(2));
}

TEST(Heartbeats, ComeFromProcessesThatHaveThePipe) {
  HeartbeatPipe pipe;
  EXPECT_THAT(pipe.take(), IsEmpty());
  const int end = std::atoi(pipe.words().back().c_str());
  const Heartbeat own(end);
  own.beat();
  own.beat();
  EXPECT_THAT(pipe.take(), ElementsAre(::getpid()));
  const pid_t child = ::fork();
  if (child == 0) {
    Heartbeat(end).beat();
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  own.beat();
  EXPECT_THAT(pipe.take(), UnorderedElementsAre(::getpid(), child));
}

/// Or signs of life would be written into somebody's file.
TEST(Heartbeats, GoNowhereButIntoAPipe) {
  std::FILE* const file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  Heartbeat(::fileno(file)).beat();
  EXPECT_EQ(::lseek(::fileno(file), 0, SEEK_END), 0);
  std::fclose(file);
  Heartbeat(-1).beat();
}

TEST(Heartbeats, NeverWaitForALauncherThatDoesNotRead) {
  HeartbeatPipe pipe;
  const Heartbeat own(std::atoi(pipe.words().back().c_str()));
  for (int i = 0; i < 100'000; ++i) own.beat();
  EXPECT_THAT(pipe.take(), ElementsAre(::getpid()));
}

}  // namespace
}  // namespace aurasim::host
