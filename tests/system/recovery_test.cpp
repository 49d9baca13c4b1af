// Nodes that are killed in runs that go back to the newest state that is kept, and compute on from there: nothing is
// lost, and every later state has the bits of the run that nobody disturbed.
#include <csignal>
#include <map>
#include <sstream>
#include <thread>

#include <signal.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class Recovery : public SystemTest {
 protected:
  std::int64_t steps_ = 480;
  const Words kDeterministic = set({"time.sync=deterministic", "survival.checkpoint=0.5"});

  Process& run_of_demo(const Words& more = {}) {
    return launch("run", launch_file("demo"), Words{"--steps", std::to_string(steps_)} + kDeterministic + more);
  }

  std::string undisturbed() {
    Process& run =
        launch("undisturbed", launch_file("demo"),
               Words{"--steps", std::to_string(steps_)} + kDeterministic + set({"regions.count=1", "time.pace=none"}));
    expect_exit(run, 0);
    return report_of("undisturbed").state_hash();
  }

  void expect_undisturbed(Process& run) {
    expect_exit(run, 0);
    const Report report = report_of("run");
    expect_all_bodies_accounted_for(report);
    EXPECT_EQ(report.count("steps"), steps_);
    EXPECT_TRUE(report.entry("dead_regions").empty());
    EXPECT_EQ(report.state_hash(), undisturbed());
  }

  /// These nodes are killed one right after the other, once all have computed 120 states.
  void expect_survives(Process& run, std::initializer_list<int> regions,
                       const std::string& goes_back = "went back to state") {
    expect_reaches(report_of("run"), 4, 120);
    for (const int region : regions) ASSERT_NO_FATAL_FAILURE(kill_node(run, region));
    EXPECT_TRUE(says(run, goes_back, 4));
    expect_undisturbed(run);
  }

  static std::size_t times(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
    return count;
  }

  bool says(Process& run, const std::string& what, std::size_t how_often = 1) {
    return wait_until([&] { return times(run.err() + run.out(), what) >= how_often; }, kGenerous);
  }
};

TEST_F(Recovery, ARegionOfADeadNodeComesBackWithTheSameBits) { expect_survives(run_of_demo(), {2}); }

/// The others are in the middle of a step, which they cannot finish.
TEST_F(Recovery, ACoupledRegionComesBackWithTheSameBits) {
  expect_survives(run_of_demo(set({"exchange=coupled"})), {2});
}

/// The new process takes the exchange from the others, and measures nothing.
TEST_F(Recovery, ARegionComesBackWithTheExchangeThatTheNodesHaveChosen) {
  expect_survives(run_of_demo(set({"exchange=auto", "exchange_limit=10"})), {2});
  EXPECT_EQ(report_of("run").entry("exchange"), "coupled");
}

TEST_F(Recovery, RegionZeroWhichHasChosenTheExchangeMayDieToo) {
  expect_survives(run_of_demo(set({"exchange=auto", "exchange_limit=10"})), {0});
  EXPECT_EQ(report_of("run").entry("exchange"), "coupled");
}

TEST_F(Recovery, RegionZeroWhichTakesOrdersMayDieToo) { expect_survives(run_of_demo(), {0}); }

TEST_F(Recovery, TwoAtOnceThatDoNotKeepEachOthersParts) { expect_survives(run_of_demo(), {1, 3}); }

/// Regions 2 and 3 keep the parts of region 1.
TEST_F(Recovery, ANodeAndOneOfItsKeepersMayDieTogether) { expect_survives(run_of_demo(), {1, 2}); }

TEST_F(Recovery, WhereANodeAndBothKeepersHaveDiedAPersonDecides) {
  Process& run = run_of_demo();
  expect_reaches(report_of("run"), 4, 120);
  for (const int region : {1, 2, 3}) ASSERT_NO_FATAL_FAILURE(kill_node(run, region));
  ASSERT_TRUE(says(run, "nobody keeps all parts of a state"));
  EXPECT_EQ(times(run.err() + run.out(), "went back to state"), 0U);
  Process& reset = start(Words{"send", "reset", launch_file("demo")} + kDeterministic + in_own_domain());
  EXPECT_TRUE(says(run, "went back to state 0", 4));
  expect_exit(reset, 0);
  expect_undisturbed(run);
}

TEST_F(Recovery, AWorldThatNobodyKnowsAnyMoreEndsTheRunWithAWord) {
  Process& run = run_of_demo();
  expect_reaches(report_of("run"), 4, 120);
  std::vector<pid_t> nodes;
  for (const int region : {0, 1, 2, 3}) nodes.push_back(node_of(run, region));
  for (const pid_t node : nodes) ::kill(node, SIGKILL);
  expect_exit(run, 1);
  EXPECT_THAT(run.err(), ::testing::HasSubstr("nobody knows the world any more"));
}

/// As with a fault of the program that comes again in the same state.
TEST_F(Recovery, ARegionWhoseNodeDiesAgainAndAgainEndsTheRunByName) {
  Process& run = launch("run", launch_file("demo"), set({"time.sync=deterministic", "survival.checkpoint=1000"}));
  expect_reaches(report_of("run"), 4, 60);
  for (std::size_t deaths = 1; deaths <= 4; ++deaths) {
    ASSERT_TRUE(wait_until([&] { return node_of(run, 2) > 0; }, kGenerous)) << "it has begun";
    ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
    if (deaths == 4) break;
    ASSERT_TRUE(says(run, "the node of region 2 is started again", deaths));
  }
  expect_exit(run, 1);
  EXPECT_THAT(run.err(),
              ::testing::HasSubstr("the run ends: the node of region 2 has died 4 times in a row near state"));
  EXPECT_THAT(run.err(), ::testing::HasSubstr("No whole world of this run is saved on this host."));
}

/// As when the nodes of a run that was started by hand have died one after the other.
TEST_F(Recovery, ThoseWhoCameToTakeOverDoNotWaitForEachOtherForEver) {
  std::vector<Process*> nodes;
  for (const char* region : {"0", "1"}) {
    nodes.push_back(&start(Words{"node", launch_file("two_spheres"), "--take-over", "--run", "5", "--region", region} +
                           kDeterministic + in_own_domain()));
  }
  for (Process* node : nodes) {
    expect_exit(*node, 1);
    EXPECT_THAT(node->err(), ::testing::HasSubstr("nobody knows the world any more"));
  }
}

TEST_F(Recovery, AnotherDeathWhileAllRecover) {
  Process& run = run_of_demo();
  expect_reaches(report_of("run"), 4, 120);
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 3));
  ASSERT_TRUE(says(run, "is started again"));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 1));
  EXPECT_TRUE(says(run, "went back to state", 4));
  expect_undisturbed(run);
}

TEST_F(Recovery, OneAfterTheOther) {
  Process& run = run_of_demo();
  expect_reaches(report_of("run"), 4, 60);
  for (int region = 0; region < 4; ++region) {
    ASSERT_NO_FATAL_FAILURE(kill_node(run, region));
    ASSERT_TRUE(says(run, "went back to state", 4 * (static_cast<std::size_t>(region) + 1)));
  }
  expect_undisturbed(run);
}

TEST_F(Recovery, ASpareTakesARegionOver) {
  Process& run = run_of_demo({"--spares", "1"});
  expect_reaches(report_of("run"), 4, 120);
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  EXPECT_TRUE(says(run, "spare: takes over region 2"));
  EXPECT_TRUE(says(run, "went back to state", 4));
  expect_undisturbed(run);
}

TEST_F(Recovery, ANodeThatIsDrainedLeavesWithoutALoss) {
  Process& run = run_of_demo();
  expect_reaches(report_of("run"), 4, 120);
  const pid_t before = node_of(run, 1);
  Process& drain = start(Words{"send", "drain", launch_file("demo"), "1"} + kDeterministic + in_own_domain());
  expect_exit(drain, 0);
  EXPECT_THAT(drain.out(), ::testing::HasSubstr("has taken region 1 over"));
  EXPECT_NE(node_of(run, 1), before);
  expect_undisturbed(run);
}

TEST_F(Recovery, AnOrderIsObeyedOnceThoughWhoTookItDies) {
  Process& run = run_of_demo();
  expect_reaches(report_of("run"), 4, 120);
  Process& spawn = start(Words{"send", "spawn", launch_file("demo"), "--radius", "0.5", "--p", "3", "3", "9"} +
                         kDeterministic + in_own_domain());
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 0));
  expect_exit(spawn, 0);
  expect_exit(run, 0);
  const Report report = report_of("run");
  expect_all_bodies_accounted_for(report);
  undisturbed();
  EXPECT_EQ(report.count("bodies_spawned"), report_of("undisturbed").count("bodies_spawned") + 1);
}

/// Its word that it takes an order is no word before others know the order.
TEST_F(Recovery, AnOrderWithATimeIsObeyedThoughWhoHasTakenItDiesAtOnce) {
  Process& run = run_of_demo();
  expect_reaches(report_of("run"), 4, 120);
  Process& spawn =
      start(Words{"send", "spawn", launch_file("demo"), "--radius", "0.5", "--p", "3", "3", "9", "--at", "400"} +
            kDeterministic + in_own_domain());
  while (spawn.running()) std::this_thread::sleep_for(1ms);
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 0));
  expect_exit(spawn, 0);
  expect_exit(run, 0);
  undisturbed();
  EXPECT_EQ(report_of("run").count("bodies_spawned"), report_of("undisturbed").count("bodies_spawned") + 1);
}

TEST_F(Recovery, AWorldThatIsPausedStaysSo) {
  steps_ = 1200;  // on a busy machine a pause can take some seconds
  Process& run = run_of_demo();
  expect_reaches(report_of("run"), 4, 120);
  const Words about = kDeterministic + in_own_domain();
  expect_exit(start(Words{"send", "pause", launch_file("demo")} + about), 0);
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 3));
  EXPECT_TRUE(says(run, "went back to state", 4));
  expect_exit(start(Words{"send", "step", launch_file("demo"), "--count", "10"} + about), 0);
  expect_exit(start(Words{"send", "resume", launch_file("demo")} + about), 0);
  expect_undisturbed(run);
}

}  // namespace
}  // namespace aurasim::system_test
