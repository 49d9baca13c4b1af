// Nodes that were started by hand, as on separate hosts, without a launcher that sees to them: who takes the region of
// a node over that dies, or that its host asks to leave.
#include <csignal>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class StartedByHand : public SystemTest {
 protected:
  static constexpr int kRegions = 4;
  static constexpr std::int64_t kSteps = 480;

  Words about_run(const Words& more = {}) const {
    return Words{launch_file("demo"), "--steps", std::to_string(kSteps), "--report", (folder() / "run").string()} +
           set({"time.sync=deterministic", "survival.checkpoint=0.5", "survival.patience=5"}) + in_own_domain() + more;
  }

  void start_nodes(const Words& more = {}) {
    for (int region = 0; region < kRegions; ++region) {
      nodes_.push_back(&start(Words{"node"} + about_run(Words{"--region", std::to_string(region)} + more)));
    }
    expect_reaches(report_of("run"), kRegions, 120);
  }

  Process& node(int region) { return *nodes_.at(static_cast<std::size_t>(region)); }

  std::string said() const {
    std::string all;
    for (const Process* node : nodes_) all += node->err() + node->out();
    return all;
  }

  bool says(const std::string& what) const {
    return wait_until([&] { return said().find(what) != std::string::npos; }, kGenerous);
  }

  /// All but `gone` come to their end, whoever has taken its region over, too, and every state is that of one node.
  void expect_undisturbed(int gone) {
    for (int region = 0; region < kRegions; ++region) {
      if (region != gone) expect_exit(node(region), 0);
    }
    expect_nobody_left(kGenerous);
    expect_exit(start(Words{"report", launch_file("demo"), (folder() / "run").string()} +
                      set({"time.sync=deterministic"}) + in_own_domain()),
                0);
    const Report report = report_of("run");
    expect_all_bodies_accounted_for(report);
    EXPECT_EQ(report.count("steps"), kSteps);
    Process& central = launch("central", launch_file("demo"),
                              Words{"--steps", std::to_string(kSteps)} +
                                  set({"time.sync=deterministic", "regions.count=1", "time.pace=none"}));
    expect_exit(central, 0);
    EXPECT_EQ(report.state_hash(), report_of("central").state_hash());
  }

  /// All but `gone` say why they end, and leave records in which no body is lost.
  void expect_all_but_one_break_off(int gone) {
    for (int region = 0; region < kRegions; ++region) {
      if (region == gone) continue;
      expect_exit(node(region), 7);
      EXPECT_THAT(node(region).err() + node(region).out(),
                  ::testing::HasSubstr("region " + std::to_string(region) + ": the run ends in state"));
    }
    expect_nobody_left(kGenerous);
    start(Words{"report", launch_file("demo"), (folder() / "run").string()} + in_own_domain()).wait(kGenerous);
    expect_all_bodies_accounted_for(report_of("run"));
    EXPECT_EQ(report_of("run").entry("dead_regions").size(), 1U);
  }

  std::vector<Process*> nodes_;
};

TEST_F(StartedByHand, WithoutASpareTheHostOfTheNextRegionTakesADeadOnesOver) {
  start_nodes();
  node(1).signal(SIGKILL);
  EXPECT_TRUE(says("nobody has taken region 1 over: this host does, beside region 2"));
  expect_undisturbed(1);
}

TEST_F(StartedByHand, ANodeWhoseHostGoesDownLeavesItsRegionToTheNextOne) {
  start_nodes();
  node(3).signal(SIGTERM);
  expect_exit(node(3), 0);
  EXPECT_TRUE(says("region 3 leaves after state"));
  EXPECT_TRUE(says("another process takes over"));
  expect_undisturbed(3);
}

TEST_F(StartedByHand, OrToASpareThatWaits) {
  Process& spare = start(Words{"spare"} + about_run());
  start_nodes();
  node(0).signal(SIGTERM);
  expect_exit(node(0), 0);
  EXPECT_TRUE(says("region 0 leaves after state"));
  expect_exit(spare, 0);
  EXPECT_THAT(spare.out() + spare.err(), ::testing::HasSubstr("takes over region 0"));
  expect_undisturbed(0);
}

/// `--has-launcher` promises somebody who starts another process. Here nobody does.
TEST_F(StartedByHand, WhereNobodyTakesADeadOnesRegionOverAllEndByName) {
  start_nodes({"--has-launcher"});
  node(1).signal(SIGKILL);
  expect_all_but_one_break_off(1);
  EXPECT_TRUE(says("nobody takes over regions [1], whose nodes have died"));
}

TEST_F(StartedByHand, WhereTheRunIsToStopAllEndByNameWithTheFirstDeath) {
  start_nodes(set({"survival.on_death=stop"}));
  node(1).signal(SIGKILL);
  expect_all_but_one_break_off(1);
  EXPECT_TRUE(says("the node of region 1 "));  // "has died", or "is silent" where that lease ends first
}

TEST_F(StartedByHand, WhenAllAreAskedToLeaveTheRunEnds) {
  start_nodes();
  for (Process* node : nodes_) node->signal(SIGTERM);
  for (Process* node : nodes_) expect_exit(*node, 0);
  expect_nobody_left(kGenerous);
}

/// Some have ended when others are in the middle of the next step.
TEST_F(StartedByHand, WhenAllAreAskedToLeaveACoupledRunEndsToo) {
  start_nodes(set({"exchange=coupled"}));
  for (Process* node : nodes_) node->signal(SIGTERM);
  for (Process* node : nodes_) expect_exit(*node, 0);
  expect_nobody_left(kGenerous);
}

}  // namespace
}  // namespace aurasim::system_test
