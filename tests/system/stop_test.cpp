// Ctrl-C.
#include <csignal>

#include <unistd.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class CtrlC : public SystemTest {
 protected:
  void expect_ends(Process& run, int signal = SIGINT) const {
    run.signal(signal);
    expect_exit(run, 0);
    EXPECT_TRUE(children_of(::getpid()).empty());
  }
};

TEST_F(CtrlC, EndsEverything) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 120));
  expect_ends(run);
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
  Process& run = launch("run", launch_file("two_spheres"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 2, 60));
  expect_exit(start(Words{"send", "pause", launch_file("two_spheres")} + in_own_domain()), 0);
  expect_ends(run);
  expect_all_bodies_accounted_for(report_of("run"));
}

TEST_F(CtrlC, EndsARunThatHasNotYetBegun) {
  Process& run = launch("run", launch_file("demo"));
  ASSERT_TRUE(wait_until([&] { return children_of(run.pid()).size() == 4; }, kGenerous));
  expect_ends(run);
}

TEST_F(CtrlC, ATerminalThatHangsUpEndsARunAsWell) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 60));
  expect_ends(run, SIGHUP);
  expect_all_bodies_accounted_for(report);
}

/// `aurasim launch FILE | head -1`: nobody reads the table any more.
TEST_F(CtrlC, AClosedPipeEndsARunAsWell) {
  const Report report = report_of("run");
  const std::string command = AURASIM_BINARY_DIR "/aurasim launch " + launch_file("two_spheres") + " --report " +
                              report.folder().string() +
                              " --set overseer.port=0 --set dds.domain=" + std::to_string(test::own_domain()) +
                              " | grep -m 1 running; exit ${PIPESTATUS[0]}";
  expect_exit(start_program({"/bin/bash", "-c", command}), 0);
  expect_all_bodies_accounted_for(report);
  for (const auto& node : report.summary().at("nodes")) EXPECT_EQ(node.at("outcome"), "finished");
}

/// All nodes stand still for longer than a healthy run takes to end, as on a machine that is busy elsewhere.
TEST_F(CtrlC, WaitsForNodesThatAreHeldUp) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 120));
  const std::vector<pid_t> nodes = children_of(run.pid());
  run.signal(SIGINT);
  for (const pid_t node : nodes) ::kill(node, SIGSTOP);
  EXPECT_TRUE(wait_until([&] { return run.err().find("waiting for the nodes") != std::string::npos; }, kGenerous));
  for (const pid_t node : nodes) ::kill(node, SIGCONT);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report);
  for (const auto& node : report.summary().at("nodes")) EXPECT_EQ(node.at("outcome"), "finished");
}

TEST_F(CtrlC, PressedOnceMoreEndsARunThatDoesNot) {
  Process& run = launch("run", launch_file("demo"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 60));
  for (const pid_t node : children_of(run.pid())) ::kill(node, SIGSTOP);
  run.signal(SIGINT);
  EXPECT_TRUE(wait_until([&] { return run.err().find("waiting for the nodes") != std::string::npos; }, kGenerous));
  run.signal(SIGINT);
  expect_exit(run, 1, 20s);  // after 30 s it would give them up by itself
  EXPECT_TRUE(children_of(::getpid()).empty());
}

}  // namespace
}  // namespace aurasim::system_test
