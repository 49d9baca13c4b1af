// Threads of the soft step.
#include <atomic>
#include <chrono>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"
#include "physics/soft/threads.h"

namespace aurasim::physics::testing {
namespace {

/// A heap of everything that falls apart, with chains in it, and fast balls that come from the side.
std::vector<core::BodyRecord> heap(core::Scene& scene) {
  std::mt19937_64 random(3);
  constexpr int kBodies = 700;
  core::SpringJoint spring;
  spring.axes[0] = {core::JointLimits{-0.1, 0.1}, 100, 1};
  spring.axes[4].stiffness = 5;
  const std::vector<core::JointKind> kinds = {core::BallJoint{}, core::FixedJoint{},
                                              core::HingeJoint{core::JointLimits{-0.5, 0.5}, core::JointMotor{2, 0.1}},
                                              core::SliderJoint{core::JointLimits{-0.1, 0.1}}, spring};
  for (int i = 0; i < kBodies; ++i) {
    const int layer = i / 49, place = i % 49;
    const core::Vec3 p(1.3 * (place % 7) + uniform(random, -0.1, 0.1), 1.3 * (place / 7), 1 + 1.3 * layer);
    place_body(scene, i % kKinds, p);
    const auto id = static_cast<std::uint64_t>(i);
    if (i % 10 == 9) add_joint(scene, kinds[random() % kinds.size()], id - 1, id, p - core::Vec3(0.65, 0, 0));
  }
  std::vector<core::BodyRecord> bodies = initial_records(scene);
  for (std::size_t i = 0; i < bodies.size(); i += 50) bodies[i].v_WB = {-40, 10, 0};
  return bodies;
}

void expect_same_bits(const core::Scene& scene, const std::vector<core::BodyRecord>& bodies, double block_m,
                      int steps) {
  std::vector<core::BodyRecord> alone;
  for (const int threads : {1, 2, 3, 8}) {
    Settings settings;
    settings.solver = Solver::kSoftStep;
    settings.block_m = block_m;
    settings.continuous = true;
    settings.threads = threads;
    RegionWorld world(scene, settings);
    world.add(bodies);
    run(world, steps);
    if (threads == 1) alone.assign(world.records().begin(), world.records().end());
    ASSERT_EQ(world.records().size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      ASSERT_EQ(world.records()[i].p_WB, alone[i].p_WB) << threads << " threads, body " << i;
      ASSERT_EQ(world.records()[i].w_WB, alone[i].w_WB) << threads << " threads, body " << i;
    }
  }
}

/// Computes a step in which the other threads take as long to come as where another process has their cores.
void step_on_a_busy_machine(soft::Team& team) {
  team.employ_for(1000);
  team.side_by_side([](const soft::Worker& worker) {
    if (!worker.is_first()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  team.rest();
}

TEST(SoftThreads, WhereOthersHaveTheCoresOneThreadWorksAlone) {
  soft::Team team(2);
  step_on_a_busy_machine(team);
  for (int step = 0; step < 60; ++step) {
    team.employ_for(1000);
    EXPECT_EQ(team.employed(), 1) << step;
    team.rest();
  }
  team.employ_for(1000);
  EXPECT_EQ(team.employed(), 2);
}

/// Each item is taken once, also where one thread is so slow that the others take pieces of its share.
TEST(SoftThreads, HelpEachOtherWithPieces) {
  constexpr std::size_t kItems = 1000;
  soft::Team team(3);
  soft::Pieces pieces(team.size());
  for (const std::size_t items : {kItems, std::size_t{0}, std::size_t{1}}) {
    std::vector<std::atomic<int>> taken(items);
    std::atomic<std::size_t> by_slow_one = 0;
    pieces.begin(items, team.employed(), 7);
    team.side_by_side([&](const soft::Worker& worker) {
      pieces.work_off(worker, [&](std::size_t first, std::size_t last) {
        EXPECT_LT(first, last);
        EXPECT_LE(last - first, 7);
        for (std::size_t i = first; i < last; ++i) ++taken[i];
        if (worker.number != 1) return;
        by_slow_one += last - first;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      });
    });
    for (const std::atomic<int>& times : taken) EXPECT_EQ(times, 1);
    EXPECT_LE(by_slow_one, 1 + items / 3);
  }
}

TEST(SoftThreads, AreFewerForFewBodies) {
  soft::Team team(8);
  const auto workers_for = [&](std::size_t bodies) {
    team.employ_for(bodies);
    std::atomic<int> workers = 0;
    team.side_by_side([&](const soft::Worker& worker) {
      ++workers;
      EXPECT_EQ(worker.of, team.employed());
    });
    return workers.load();
  };
  EXPECT_EQ(workers_for(0), 1);
  EXPECT_EQ(workers_for(50), 1);
  EXPECT_EQ(workers_for(100), 3);
  EXPECT_EQ(workers_for(10000), 8);
  EXPECT_EQ(workers_for(100), 3);
}

/// A hundred stacks fall asleep, so that fewer threads have something to do. Then balls roll into them.
TEST(SoftThreads, WhoHasNothingToDoAnyMoreLeavesNothingBehind) {
  core::Scene scene = scene_of_all_shapes();
  scene.materials[0].rolling_friction = scene.materials[0].linear_damping = scene.materials[0].angular_damping = 0;
  for (int i = 0; i < 200; ++i) {
    place_body(scene, kBox, {3.0 * (i / 2 % 10), 3.0 * (i / 20), 0.45 + 0.9 * (i % 2)});
  }
  for (int i = 0; i < 20; ++i) place_body(scene, kSphere, {3.0 * (i % 10), -40.0 - 3 * (i / 10), 0.4});
  std::vector<core::BodyRecord> bodies = initial_records(scene);
  for (std::size_t i = 200; i < bodies.size(); ++i) bodies[i].v_WB = {0, 10 + 0.1 * static_cast<double>(i % 10), 0};
  expect_same_bits(scene, bodies, 16, 400);
}

/// Longer than a thread looks again before it sleeps, and shorter.
TEST(SoftThreads, AllComeBackAfterAnyTime) {
  soft::Team team(3);
  std::vector<int> turns(3, 0);
  for (int time = 0; time < 200; ++time) {
    if (time % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    team.side_by_side([&](const soft::Worker& worker) {
      for (int turn = 0; turn < 5; ++turn) {
        int& own = turns[static_cast<std::size_t>(worker.number)];
        ++own;
        worker.wait();
        for (const int other : turns) EXPECT_EQ(other, own);
        worker.wait();
      }
    });
  }
  EXPECT_EQ(turns, std::vector<int>(3, 1000));
}

TEST(SoftThreads, TheirNumberChangesNoBit) {
  core::Scene scene = scene_of_all_shapes();
  const std::vector<core::BodyRecord> bodies = heap(scene);
  expect_same_bits(scene, bodies, 6, 150);
}

/// Small blocks, so that the threads have many, with a chain over all of them and a few giants.
TEST(SoftThreads, TheirNumberChangesNoBitOverManyBlocks) {
  core::Scene scene = scene_of(core::Box{core::Vec3::Constant(0.2)});
  core::Prototype plate = scene.prototypes[0];
  plate.shape = static_cast<std::uint32_t>(scene.shapes.size());
  plate.mass_kg = 20;
  scene.shapes.push_back({"plate", core::Box{{3, 1, 0.1}}});
  scene.prototypes.push_back(plate);
  for (int i = 0; i < 900; ++i) place_body(scene, 0, {0.42 * (i % 30), 0.42 * (i / 30 % 10), 0.2 + 0.4 * (i / 300)});
  for (int i = 0; i < 4; ++i) place_body(scene, 1, {0.2 + 6.1 * i, 2, 1.35});
  for (int i = 0; i < 30; ++i) {
    place_body(scene, 0, {0.41 * i, 2, 1.7});
    const std::uint64_t id = scene.bodies.size() - 1;
    if (i > 0) add_joint(scene, core::BallJoint{}, id - 1, id, {0.41 * i - 0.205, 2, 1.7});
  }
  expect_same_bits(scene, initial_records(scene), 2, 60);
  expect_same_bits(scene, initial_records(scene), 4, 60);
}

}  // namespace
}  // namespace aurasim::physics::testing
