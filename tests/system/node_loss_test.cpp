// Nodes that are killed in runs that stop then (recovery_test.cpp: that go back), and launchers.
#include <algorithm>
#include <csignal>
#include <map>
#include <set>

#include <unistd.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

const Words kStops = set({"survival.on_death=stop"});

class NodeLoss : public SystemTest {
 protected:
  /// All but the dead one say that the run has broken off, in states that are at most a lookahead apart.
  void expect_survivors_break_off(const Report& report, int dead) const {
    std::set<std::int64_t> last;
    const nlohmann::json nodes = report.summary().at("nodes");
    for (int region = 0; region < 4; ++region) {
      const nlohmann::json& node = nodes.at(static_cast<std::size_t>(region));
      EXPECT_EQ(node.at("outcome"), region == dead ? "died" : "broken off");
      if (region != dead) last.insert(node.at("steps").get<std::int64_t>());
    }
    EXPECT_LE(*last.rbegin() - *last.begin(), 2 * kLookahead) << "they wait for each other";
  }

  /// The summary names the dead region and its bodies, and whoever is not among them lives on exactly one survivor:
  /// here, or in a hand-off of the last state, whose sender still keeps it (a row of its own, of the same epoch).
  void expect_bodies_named(const Report& report, int dead, std::int64_t bodies_at_start) const {
    const nlohmann::json regions = report.entry("dead_regions");
    ASSERT_EQ(regions.size(), 1U);
    EXPECT_EQ(regions[0].at("region"), dead);
    const auto gone = regions[0].at("bodies").get<std::set<std::int64_t>>();
    EXPECT_FALSE(gone.empty());
    std::map<std::int64_t, std::int64_t> here, under_way;  // body -> epoch
    for (int region = 0; region < 4; ++region) {
      if (region == dead) continue;
      const Table bodies(report.region_folder(region) / "bodies.csv");
      for (std::size_t row = 0; row < bodies.rows(); ++row) {
        const std::int64_t body = bodies.whole(row, "body");
        auto& where = bodies.text(row, "where") == "here" ? here : under_way;
        EXPECT_TRUE(where.emplace(body, bodies.whole(row, "epoch")).second) << "twice: body " << body;
        EXPECT_FALSE(gone.contains(body)) << "alive and gone: body " << body;
      }
    }
    for (const auto& [body, epoch] : under_way) {
      const auto arrived = here.find(body);
      if (arrived == here.end()) continue;
      EXPECT_GE(arrived->second, epoch) << "given away and still here: body " << body;
    }
    for (std::int64_t body = 0; body < bodies_at_start; ++body) {
      EXPECT_TRUE(here.contains(body) || under_way.contains(body) || gone.contains(body))
          << "neither alive nor gone: body " << body;
    }
  }

  /// Bodies that the records know: alive on a survivor, or named as gone with a dead region.
  std::set<std::int64_t> bodies_known(const Report& report, int regions, int dead) const {
    std::set<std::int64_t> known;
    for (int region = 0; region < regions; ++region) {
      if (region == dead) continue;
      const Table bodies(report.region_folder(region) / "bodies.csv");
      for (std::size_t row = 0; row < bodies.rows(); ++row) known.insert(bodies.whole(row, "body"));
    }
    for (const auto& region : report.entry("dead_regions")) {
      for (const auto& body : region.at("bodies")) known.insert(body.get<std::int64_t>());
    }
    return known;
  }

  /// Bodies that exist in state `last` of the demo, as its central run tells.
  std::set<std::int64_t> bodies_born(std::int64_t last) {
    Process& run = launch("central", launch_file("demo"),
                          Words{"--steps", std::to_string(last)} + set({"regions.count=1", "time.pace=none"}));
    expect_exit(run, 0);
    const Table births(report_of("central").region_folder(0) / "births.csv");
    std::set<std::int64_t> born;
    for (std::size_t row = 0; row < births.rows(); ++row) {
      if (births.whole(row, "birth_step") <= last) born.insert(births.whole(row, "body"));
    }
    return born;
  }

  /// `aurasim send`; returns the step that it names.
  std::int64_t send(const Words& words) {
    Process& program = start(Words{"send"} + words + Words{launch_file("demo")} + kStops + in_own_domain());
    expect_exit(program, 0);
    const std::string said = program.out();
    const std::size_t at = said.find("step ");
    return at == std::string::npos ? -1 : std::stoll(said.substr(at + 5));
  }

  void expect_run_ends_with(int dead) {
    const Report report = report_of("run");
    const std::string saves = (folder() / "saves").string();
    Process& run = launch("run", launch_file("demo"), Words{"--saves", saves, "--save-every", "1"} + kStops);
    ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 240));  // three worlds are saved by then
    ASSERT_NO_FATAL_FAILURE(kill_node(run, dead));
    expect_exit(run, 1);
    EXPECT_THAT(run.err(),
                ::testing::HasSubstr("the node of region " + std::to_string(dead) + " died (exit code 137)"));
    EXPECT_THAT(run.err(),
                ::testing::ContainsRegex("the run ends: survival.on_death is stop. The newest saved world of "
                                         "this run is of state [0-9]+: `aurasim launch .* --load .*/state-"));
    expect_all_bodies_accounted_for(report);
    expect_survivors_break_off(report, dead);
    expect_bodies_named(report, dead, 96);
  }

  static constexpr std::int64_t kLookahead = 2;  ///< of the demo
};

TEST_F(NodeLoss, ARunThatStopsWhenANodeDiesEndsByName) { expect_run_ends_with(2); }

TEST_F(NodeLoss, RegionZeroWhichStartedTheRunMayDieToo) { expect_run_ends_with(0); }

/// Survivors wait in the middle of a state. The launcher asks them to end before they know why.
TEST_F(NodeLoss, ACoupledRunThatStopsWhenANodeDiesIsBrokenOff) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"), kStops + set({"exchange=coupled"}));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 60));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 1));
  expect_exit(run, 1);
  expect_survivors_break_off(report, 1);
}

// Nodes write their records to disk every 60 steps. Killed just before that, while paused, so that the step is known.
TEST_F(NodeLoss, NoBodyOfADeadNodeIsForgotten) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"), kStops);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 60));
  const std::int64_t paused_at = send({"pause"});
  ASSERT_GT(paused_at, 0);
  const std::int64_t dies_at = (paused_at / 60 + 1) * 60 + 55;
  ASSERT_EQ(send({"step", "--count", std::to_string(dies_at - paused_at)}), dies_at);
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  expect_exit(run, 1);
  EXPECT_THAT(run.err(), ::testing::HasSubstr("region 2 died"));
  expect_all_bodies_accounted_for(report);
  const std::set<std::int64_t> known = bodies_known(report, 4, 2);
  std::set<std::int64_t> forgotten = bodies_born(dies_at);
  std::erase_if(forgotten, [&](std::int64_t body) { return known.contains(body); });
  EXPECT_THAT(forgotten, ::testing::IsEmpty());
}

TEST_F(NodeLoss, ANodeThatHangsIsEndedAndTheRunWithIt) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"), kStops);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 60));
  const pid_t node = node_of(run, 2);
  ASSERT_GT(node, 0);
  ::kill(node, SIGSTOP);
  expect_exit(run, 1);
  EXPECT_THAT(run.err(), ::testing::HasSubstr("the node of region 2 has shown no life for"));
  EXPECT_THAT(run.err(), ::testing::HasSubstr("region 2 died (exit code 137)"));
  expect_all_bodies_accounted_for(report);
  expect_survivors_break_off(report, 2);
}

TEST_F(NodeLoss, WhoDiesWhileTheNodesMeetIsNamedAndNobodyWaitsForIt) {
  Process& run = launch("run", launch_file("demo"));
  ASSERT_TRUE(wait_until([&] { return node_of(run, 2) > 0; }, kGenerous));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  expect_exit(run, 1, 25s);  // the others would wait for 30 s
  EXPECT_THAT(run.err(), ::testing::HasSubstr("region 2 died (exit code 137) before the run had begun"));
  EXPECT_THAT(run.err(), ::testing::Not(::testing::HasSubstr("cannot write")));
}

/// At any moment of their beginning.
TEST_F(NodeLoss, AKilledLauncherTakesNodesAlongThatHaveJustBegun) {
  for (std::size_t nodes = 1; nodes <= 4; ++nodes) {
    Process& run = launch("run", launch_file("demo"));
    ASSERT_TRUE(wait_until([&] { return children_of(run.pid()).size() >= nodes; }, kGenerous));
    run.signal(SIGKILL);
    expect_exit(run, 128 + SIGKILL);
    expect_nobody_left(kGenerous);
  }
}

TEST_F(NodeLoss, AKilledLauncherTakesItsNodesAlong) {
  Process& run = launch("run", launch_file("demo"));
  expect_reaches(report_of("run"), 4, 60);
  run.signal(SIGKILL);
  expect_exit(run, 128 + SIGKILL);
  EXPECT_FALSE(children_of(::getpid()).empty()) << "orphans, for a moment";
  expect_nobody_left(kGenerous);
}

}  // namespace
}  // namespace aurasim::system_test
