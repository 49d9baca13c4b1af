// A process that is started ends with its parent, even one that does not listen.
#include "host/spawn.h"

#include <array>
#include <csignal>
#include <ctime>

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include "host/stop_signal.h"

namespace aurasim::host {
namespace {

/// Waits for any child; its id, and how it ended in `status`. 0 if none has ended after a minute.
pid_t reap(int& status) {
  for (int i = 0; i < 60'000; ++i) {
    if (const pid_t pid = ::waitpid(-1, &status, WNOHANG); pid != 0) return pid;
    const ::timespec nap{0, 1'000'000};
    ::nanosleep(&nap, nullptr);
  }
  return 0;
}

/// Runs `parent` in a process of its own that then dies as by kill -9; what `parent` has started is ours afterwards.
template <class Parent>
void orphan(Parent&& parent) {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t pid = ::fork();
  ASSERT_GE(pid, 0);
  if (pid == 0) {
    parent();
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);
  ASSERT_TRUE(WIFSIGNALED(status));
}

/// Signals that our handler takes between fork and exec would be lost: nobody would tell the program again.
TEST(Spawn, AProcessOfAKilledParentEndsAtAnyMomentOfItsBeginning) {
  for (int i = 0; i < 200; ++i) {
    orphan([] {
      catch_stop_signals();
      spawn({"/bin/sleep", "1000"});
    });
    int status = 0;
    ASSERT_GT(reap(status), 0);
    if (WIFSIGNALED(status)) {
      EXPECT_EQ(WTERMSIG(status), SIGTERM);
    }
  }
}

TEST(Spawn, AProgramThatIsNotThereEndsWithItsOwnExitCode) {
  const pid_t pid = spawn({"/nonexistent"});
  int status = 0;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);
  EXPECT_EQ(WEXITSTATUS(status), 127);
}

TEST(StopSignals, AreCountedAndDoNotEndTheProcess) {
  const pid_t pid = ::fork();
  if (pid == 0) {
    catch_stop_signals();
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::raise(signal);
    ::raise(SIGPIPE);
    ::raise(SIGXFSZ);
    ::_exit(stop_requests());
  }
  int status = 0;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
}

TEST(StopSignals, LeaveNohupAlone) {
  const pid_t pid = ::fork();
  if (pid == 0) {
    std::signal(SIGHUP, SIG_IGN);
    catch_stop_signals();
    ::raise(SIGHUP);
    ::_exit(stop_requests());
  }
  int status = 0;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

/// It is told to stop, but its thread is stuck and nobody is left who would kill it. (Takes no 30 s: the alarm is
/// seen.)
TEST(StopSignals, AProcessThatIsToldToStopAfterItsParentDiedHasLimitedTime) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  orphan([&] {
    const pid_t middle = ::getpid();
    if (::fork() != 0) {
      char ready = 0;
      [[maybe_unused]] const auto n = ::read(pipe[0], &ready, 1);
      return;
    }
    catch_stop_signals();
    [[maybe_unused]] auto n = ::write(pipe[1], "r", 1);
    while (::getppid() == middle) {
      const ::timespec nap{0, 1'000'000};
      ::nanosleep(&nap, nullptr);
    }
    ::raise(SIGTERM);
    ::_exit(::alarm(0) > 0 ? 7 : 0);
  });
  int status = 0;
  ASSERT_GT(reap(status), 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

}  // namespace
}  // namespace aurasim::host
