// docs/design.md, "The same bits": the hash of every state is equal on any number of nodes.

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class Determinism : public SystemTest {
 protected:
  /// The hash of every state, by `steps` states computed as fast as it goes.
  std::string hashes(const std::string& name, const std::string& scene, int steps, const Words& overrides = {}) {
    Process& run = launch(
        name, launch_file(scene),
        Words{"--steps", std::to_string(steps)} + set(Words{"time.sync=deterministic", "time.pace=none"} + overrides));
    expect_exit(run, 0);
    expect_all_bodies_accounted_for(report_of(name));
    return report_of(name).state_hash();
  }

  std::int64_t hand_offs(const std::string& name) const { return report_of(name).count("migrations"); }
};

TEST_F(Determinism, DeterministicRunsAreEqual) {
  const std::string first = hashes("first", "demo", 300);
  EXPECT_GT(hand_offs("first"), 50);
  EXPECT_EQ(first_difference(first, hashes("again", "demo", 300)), "");
  EXPECT_EQ(first_difference(first, hashes("central", "demo", 300, {"regions.count=1"})), "");
  EXPECT_EQ(hand_offs("central"), 0);
  EXPECT_EQ(first_difference(first, hashes("columns", "demo", 300, {"regions={layout: columns, count: 2, width: 40}"})),
            "");
}

TEST_F(Determinism, CoupledRegionsAreEqualToTheCentralRun) {
  const Words coupled = {"exchange=coupled"};
  for (const std::string scene : {"corner_stacks", "demo"}) {
    const std::string many = hashes(scene + "_coupled", scene, 400, coupled);
    EXPECT_GT(hand_offs(scene + "_coupled"), 0);
    EXPECT_EQ(report_of(scene + "_coupled").count("late_collisions"), 0);
    EXPECT_EQ(first_difference(many, hashes(scene + "_central", scene, 400, {"regions.count=1"})), "") << scene;
  }
}

/// A tree connects so many nodes (core/seam_tree.h), and most of them do not listen to each other.
TEST_F(Determinism, TenCoupledRegionsAreEqualToTheCentralRun) {
  const Words block = {"physics.block=4"};
  const std::string many =
      hashes("ten", "demo", 200, block + Words{"exchange=coupled", "regions={layout: columns, count: 10, width: 4}"});
  EXPECT_GT(hand_offs("ten"), 0);
  EXPECT_EQ(first_difference(many, hashes("one", "demo", 200, block + Words{"regions.count=1"})), "");
}

TEST_F(Determinism, WhatAutoMeansIsMeasuredAndHasTheBitsOfTheCentralRun) {
  const std::string central = hashes("auto_central", "demo", 300, {"regions.count=1"});
  const std::string near = hashes("near", "demo", 300, {"exchange=auto", "exchange_limit=10"});
  EXPECT_EQ(report_of("near").entry("exchange"), "coupled");
  EXPECT_EQ(first_difference(near, central), "");
  const std::string far = hashes("far", "demo", 300, {"exchange=auto", "exchange_limit=0.000001"});
  EXPECT_EQ(report_of("far").entry("exchange"), "aura");
  EXPECT_EQ(first_difference(far, central), "");
}

/// Without auras the demo first goes wrong at a border in state 434.
constexpr int kUntilBordersMatter = 600;

TEST_F(Determinism, WithoutAurasTheRunDiffersFromTheCentralOne) {
  const std::string naive = hashes("naive", "demo", kUntilBordersMatter, {"aura.radius=none", "time.redo=off"});
  const std::string central = hashes("central", "demo", kUntilBordersMatter, {"regions.count=1"});
  EXPECT_NE(first_difference(naive, central), "") << "or this test could not see a difference";
}

TEST_F(Determinism, WithoutAurasARedoGivesTheBitsOfTheCentralOne) {
  const std::string redone = hashes("redone", "demo", kUntilBordersMatter, {"aura.radius=none"});
  EXPECT_EQ(first_difference(redone, hashes("central", "demo", kUntilBordersMatter, {"regions.count=1"})), "");
}

/// Bounded mode does not promise the bits, only that nothing is wrong. Where no promise is broken they come all the
/// same. The dominoes fall over the border in states 700 to 900.
TEST_F(Determinism, InBoundedModeTheTowerAndTheDominoesFallAsInOneWorld) {
  for (const std::string scene : {"tower", "domino_line"}) {
    const Words bounded = {"time.sync=bounded", "exchange=aura"};
    const std::string two =
        hashes(scene + "_2", scene, 900,
               bounded + Words{"regions={layout: columns, count: 2, width: 40, neighbour_distance: 1000}"});
    EXPECT_GT(hand_offs(scene + "_2"), 0);
    const std::string one = hashes(scene + "_1", scene, 900, bounded + Words{"regions.count=1"});
    EXPECT_EQ(first_difference(two, one), "") << scene;
  }
}

struct Scene {
  const char* name;
  int steps;
};

void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }

class EveryScene : public Determinism, public ::testing::WithParamInterface<Scene> {};

TEST_P(EveryScene, IsEqualToTheCentralRun) {
  const auto [name, steps] = GetParam();
  const std::string distributed = hashes("distributed", name, steps);
  EXPECT_GT(hand_offs("distributed"), 0);
  EXPECT_EQ(first_difference(distributed, hashes("central", name, steps, {"regions.count=1"})), "");
}

INSTANTIATE_TEST_SUITE_P(Shipped, EveryScene,
                         ::testing::Values(Scene{"two_spheres", 300}, Scene{"island", 600}, Scene{"three_way", 600},
                                           Scene{"tower", 600}, Scene{"columns_rain", 400}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace aurasim::system_test
