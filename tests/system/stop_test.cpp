// Ctrl-C. Domains 137 to 139, 167 and 168.
#include <csignal>

#include <unistd.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class CtrlC : public SystemTest {
 protected:
  void expect_ends_within_two_seconds(Process& run) const {
    run.signal(SIGINT);
    expect_exit(run, 0, 2s);
    EXPECT_TRUE(children_of(::getpid()).empty());
  }
};

TEST_F(CtrlC, EndsEverythingWithinTwoSeconds) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"), 137);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 120));
  expect_ends_within_two_seconds(run);
  expect_all_bodies_accounted_for(report);
  EXPECT_GE(report.count("steps"), 120);
  EXPECT_GT(report.count("bodies_alive"), 96);
  const nlohmann::json summary = report.summary();
  ASSERT_EQ(summary.at("nodes").size(), 4U);
  for (const auto& node : summary.at("nodes")) {
    EXPECT_EQ(node.at("outcome"), "finished");
    EXPECT_EQ(node.at("steps"), summary.at("steps")) << "all stop at the same state";
  }
}

TEST_F(CtrlC, EndsARunThatIsPaused) {
  Process& run = launch("run", launch_file("two_spheres"), 138);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 2, 60));
  expect_exit(start(Words{"send", "pause", launch_file("two_spheres")} + set({"dds.domain=138"})), 0);
  expect_ends_within_two_seconds(run);
  expect_all_bodies_accounted_for(report_of("run"));
}

TEST_F(CtrlC, EndsARunThatHasNotYetBegun) {
  Process& run = launch("run", launch_file("demo"), 139);
  ASSERT_TRUE(wait_until([&] { return children_of(run.pid()).size() == 4; }, 5s));
  expect_ends_within_two_seconds(run);
}

/// All nodes stand still for longer than a healthy run takes to end, as on a machine that is busy elsewhere.
TEST_F(CtrlC, WaitsForNodesThatAreHeldUp) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"), 167);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 120));
  const std::vector<pid_t> nodes = children_of(run.pid());
  run.signal(SIGINT);
  for (const pid_t node : nodes) ::kill(node, SIGSTOP);
  EXPECT_TRUE(wait_until([&] { return run.err().find("waiting for the nodes") != std::string::npos; }, 4s));
  for (const pid_t node : nodes) ::kill(node, SIGCONT);
  expect_exit(run, 0, 10s);
  expect_all_bodies_accounted_for(report);
  for (const auto& node : report.summary().at("nodes")) EXPECT_EQ(node.at("outcome"), "finished");
}

TEST_F(CtrlC, PressedOnceMoreEndsARunThatDoesNot) {
  Process& run = launch("run", launch_file("demo"), 168);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 60));
  for (const pid_t node : children_of(run.pid())) ::kill(node, SIGSTOP);
  run.signal(SIGINT);
  EXPECT_TRUE(wait_until([&] { return run.err().find("waiting for the nodes") != std::string::npos; }, 4s));
  run.signal(SIGINT);
  expect_exit(run, 1, 1s);
  EXPECT_TRUE(children_of(::getpid()).empty());
}

}  // namespace
}  // namespace aurasim::system_test
