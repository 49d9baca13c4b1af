// Nodes that are killed in runs that go on without them (recovery_test.cpp: that go back), and launchers. The
// liveliness lease of qos/aurasim.xml is 1 s.
#include <algorithm>
#include <csignal>
#include <map>
#include <set>

#include <unistd.h>

#include "dds/control.h"
#include "node/pacer.h"
#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

constexpr double kLongestWaitMs = 15'000;  // the lease, and margin for a busy host

const Words kGoesOn = set({"survival.on_death=go_on"});

class NodeLoss : public SystemTest {
 protected:
  void expect_survivors_finish(const Report& report, int dead, std::int64_t last) const {
    std::map<int, std::int64_t> reached;
    std::map<int, double> longest_wait_ms;
    const Table steps = report.steps();
    for (std::size_t row = 0; row < steps.rows(); ++row) {
      const int region = static_cast<int>(steps.whole(row, "region"));
      reached[region] = std::max(reached[region], steps.whole(row, "step"));
      longest_wait_ms[region] = std::max(longest_wait_ms[region], steps.number(row, "wait_ms"));
    }
    for (const auto& [region, step] : reached) {
      if (region == dead) continue;
      EXPECT_EQ(step, last) << "region " << region;
      EXPECT_LT(longest_wait_ms[region], kLongestWaitMs) << "region " << region;
    }
    EXPECT_EQ(reached.size(), 4U);
    EXPECT_LT(reached[dead], last);
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
    Process& program = start(Words{"send"} + words + Words{launch_file("demo")} + kGoesOn + in_own_domain());
    expect_exit(program, 0);
    const std::string said = program.out();
    const std::size_t at = said.find("step ");
    return at == std::string::npos ? -1 : std::stoll(said.substr(at + 5));
  }

  void expect_region_can_die(int dead) {
    const Report report = report_of("run");
    Process& run = launch("run", launch_file("demo"), Words{"--duration", "6"} + kGoesOn);
    expect_reaches(report, 4, 120);
    ASSERT_NO_FATAL_FAILURE(kill_node(run, dead));
    expect_exit(run, 1);
    EXPECT_THAT(run.err(), ::testing::HasSubstr("region " + std::to_string(dead) + " died"));
    expect_all_bodies_accounted_for(report);
    EXPECT_EQ(report.count("steps"), 360);
    expect_survivors_finish(report, dead, 360);
    expect_bodies_named(report, dead, 96);
  }
};

TEST_F(NodeLoss, KillOneNodeOfFour) { expect_region_can_die(2); }

TEST_F(NodeLoss, RegionZeroWhichStartedTheRunMayDieToo) { expect_region_can_die(0); }

// Nodes write their records to disk every 60 steps. Killed just before that, while paused, so that the step is known.
TEST_F(NodeLoss, NoBodyOfADeadNodeIsForgotten) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"), kGoesOn);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 60));
  const std::int64_t paused_at = send({"pause"});
  ASSERT_GT(paused_at, 0);
  const std::int64_t dies_at = (paused_at / 60 + 1) * 60 + 55;
  ASSERT_EQ(send({"step", "--count", std::to_string(dies_at - paused_at)}), dies_at);
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  ASSERT_TRUE(wait_until([&] { return run.err().find("region 2 died") != std::string::npos; }, kGenerous));
  send({"stop"});
  expect_exit(run, 1);
  expect_all_bodies_accounted_for(report);
  const std::set<std::int64_t> known = bodies_known(report, 4, 2);
  std::set<std::int64_t> forgotten = bodies_born(dies_at);
  std::erase_if(forgotten, [&](std::int64_t body) { return known.contains(body); });
  EXPECT_THAT(forgotten, ::testing::IsEmpty());
}

// Its participant's lease is 5 s: the others have given it up, and it must not go on as if nothing had been.
TEST_F(NodeLoss, ANodeThatWasHeldUpForLongerThanItsLeaseStops) {
  const Report report = report_of("run");
  Process& run = launch("run", launch_file("demo"), Words{"--duration", "10"} + kGoesOn);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report, 4, 60));
  const pid_t node = node_of(run, 2);
  ASSERT_GT(node, 0);
  ::kill(node, SIGSTOP);
  const auto until = Clock::now() + 7s;
  EXPECT_FALSE(wait_until([&] { return Clock::now() > until && !run.running(); }, 7s));
  ::kill(node, SIGCONT);
  expect_exit(run, 1);
  EXPECT_THAT(run.err(), ::testing::HasSubstr("region 2 died (exit code 4)"));
  expect_all_bodies_accounted_for(report);
  expect_survivors_finish(report, 2, 600);
}

TEST_F(NodeLoss, WhoDiesWhileTheNodesMeetIsNamedAndNobodyWaitsForIt) {
  Process& run = launch("run", launch_file("demo"));
  ASSERT_TRUE(wait_until([&] { return node_of(run, 2) > 0; }, kGenerous));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  expect_exit(run, 1, 25s);  // the others would wait for 30 s
  EXPECT_THAT(run.err(), ::testing::HasSubstr("region 2 died (exit code 137) before the run had begun"));
  EXPECT_THAT(run.err(), ::testing::Not(::testing::HasSubstr("cannot write")));
}

/// All nodes would have to come back to state 0, and the dead one's bodies with them.
TEST_F(NodeLoss, AResetAfterADeathIsRefusedByNameAndTheRunCanStillBeSteered) {
  Process& run = launch("run", launch_file("demo"), kGoesOn);
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 60));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  ASSERT_TRUE(wait_until([&] { return run.err().find("region 2 died") != std::string::npos; }, kGenerous));
  const auto refused = [&] {
    Process& reset = start(Words{"send", "reset", launch_file("demo")} + kGoesOn + in_own_domain());
    return reset.wait(kGenerous) == 1 && reset.err().find("dead regions [2]") != std::string::npos;
  };
  EXPECT_TRUE(refused());
  EXPECT_GT(send({"pause"}), 60);
  EXPECT_GT(send({"resume"}), 60);
  send({"stop"});
  expect_exit(run, 1);
  expect_all_bodies_accounted_for(report_of("run"));
}

/// As when a node dies while a reset is under way.
TEST_F(NodeLoss, SurvivorsOfAResetDoNotWaitForTheDead) {
  Process& run = launch("run", launch_file("demo"), kGoesOn);
  dds::Settings settings;
  settings.domain = test::own_domain();
  settings.profiles = AURASIM_SOURCE_DIR "/qos/aurasim.xml";
  dds::Participant participant(settings);
  dds::ControlBus control(participant, {});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 60));
  ASSERT_NO_FATAL_FAILURE(kill_node(run, 2));
  const auto survivors = [&](const auto& condition) {
    control.wait(20ms);
    const auto& statuses = control.statuses();
    return std::count_if(statuses.begin(), statuses.end(), [&](const auto& entry) {
             return entry.first != core::RegionId{2} && condition(entry.second.status);
           }) == 3;
  };
  ASSERT_TRUE(
      wait_until([&] { return survivors([](const auto& s) { return !s.dead.empty() && s.step > 60; }); }, kGenerous));
  dds::RunCommand reset;
  reset.kind = dds::RunCommandKind::kReset;
  for (const auto& [region, seen] : control.statuses()) reset.at_step = std::max(reset.at_step, seen.status.step + 60);
  reset.epoch_ns = node::wall_clock_ns() + 1'500'000'000;
  control.send(reset);
  EXPECT_TRUE(
      wait_until([&] { return survivors([](const auto& s) { return s.generation == 1 && s.step > 90; }); }, kGenerous));
  run.signal(SIGINT);
  expect_exit(run, 1);
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
