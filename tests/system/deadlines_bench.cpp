// What has to be quick, on a machine that has nothing else to do: `ctest -R deadlines`. The tests of the same things
// wait as long as a busy machine needs.
#include <csignal>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class Deadlines : public SystemTest {
 protected:
  void expect_ends_within(Process& run, Clock::duration deadline) const {
    const auto begin = Clock::now();
    run.signal(SIGINT);
    expect_exit(run, 0);
    const double taken_s = std::chrono::duration<double>(Clock::now() - begin).count();
    RecordProperty("seconds", std::to_string(taken_s));
    EXPECT_LT(taken_s, std::chrono::duration<double>(deadline).count());
  }
};

TEST_F(Deadlines, CtrlCEndsARunWithinTwoSeconds) {
  Process& run = launch("run", launch_file("demo"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 120));
  expect_ends_within(run, 2s);
}

TEST_F(Deadlines, CtrlCEndsAPausedRunWithinTwoSeconds) {
  Process& run = launch("run", launch_file("two_spheres"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 2, 60));
  expect_exit(start(Words{"send", "pause", launch_file("two_spheres")} + in_own_domain()), 0);
  expect_ends_within(run, 2s);
}

TEST_F(Deadlines, CtrlCEndsARunThatHasNotYetBegunWithinTwoSeconds) {
  Process& run = launch("run", launch_file("demo"));
  ASSERT_TRUE(wait_until([&] { return children_of(run.pid()).size() == 4; }, kGenerous));
  expect_ends_within(run, 2s);
}

TEST_F(Deadlines, ANodeThatDiesWhileTheyMeetEndsTheRunWithinTwoSeconds) {
  Process& run = launch("run", launch_file("demo"));
  ASSERT_TRUE(wait_until([&] { return children_of(run.pid()).size() == 4; }, kGenerous));
  const auto begin = Clock::now();
  ::kill(children_of(run.pid()).front(), SIGKILL);
  expect_exit(run, 1);
  EXPECT_LT(Clock::now() - begin, 2s);
}

}  // namespace
}  // namespace aurasim::system_test
