// Each solver keeps the bits when bodies change hosts: none remembers what it solved before.
#include <iostream>

#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"
#include "physics/solver_names.h"

namespace aurasim::test {
namespace {

class SolverBits : public testing::TestWithParam<physics::Solver> {};

/// Returns the number of hand-offs.
std::uint64_t expect_bits_of_central_run(const core::Scene& scene, const ClusterOptions& options, core::Step steps) {
  const Outcome o = CheckedRun(scene, options).run(steps);
  EXPECT_EQ(o.hash, run_central(scene, options, steps).hash) << "seed " << options.seed;
  EXPECT_EQ(o.late + o.missed + o.lost + o.doubled, 0u) << "seed " << options.seed;
  return o.hand_offs;
}

TEST_P(SolverBits, AreThoseOfTheCentralRun) {
  std::uint64_t hand_offs = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const core::Scene scene = thrown_bodies(50, 12, 12, 10, seed);
    ClusterOptions options;
    options.map = seed == 3 ? core::RegionMap::grid(2, 2, 9, 9) : core::RegionMap::columns(2, 9);
    options.sync = core::SyncMode::kDeterministic;
    options.physics.solver = GetParam();
    options.physics.block_m = 7;
    options.physics.friction_directions = static_cast<int>(1 + seed % 2);
    options.seed = seed;
    options.aura.lookahead = static_cast<int>(1 + seed % 2);
    options.aura.top_speed_m_s = 40;
    options.network.loss = 0.05;
    hand_offs += expect_bits_of_central_run(scene, options, 180);
  }
  EXPECT_GT(hand_offs, 0u);
  std::cout << hand_offs << " hand-offs\n";
}

TEST_P(SolverBits, OfDrivenJointsAreThoseOfTheCentralRun) {
  std::uint64_t hand_offs = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const core::Scene scene = driven_pairs(40, 16, 16, 8, seed);
    ClusterOptions options;
    options.map = seed == 1 ? core::RegionMap::grid(2, 2, 9, 9) : core::RegionMap::columns(2, 9);
    options.sync = core::SyncMode::kDeterministic;
    options.physics.solver = GetParam();
    options.physics.block_m = 7;
    options.seed = seed;
    options.aura.lookahead = 1;
    options.aura.top_speed_m_s = 60;
    options.bandwidth_B_s = lab::kUnlimited_B_s;
    hand_offs += expect_bits_of_central_run(scene, options, 240);
  }
  EXPECT_GT(hand_offs, 0u);
  std::cout << hand_offs << " hand-offs\n";
}

/// Tiles and a mesh, side by side, with nothing but air around them. A tile goes down and comes back, if it may move.
void lay_floor(core::Scene& scene, bool moves) {
  constexpr double kTile = 1.3;
  const auto add = [&scene](const core::Shape& shape, const core::Vec3& p) {
    scene.shapes.push_back({"piece", shape});
    core::StaticBody piece;
    piece.name = "piece " + std::to_string(scene.statics.size() + 1);
    piece.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
    piece.pose.p_WB = p;
    scene.statics.push_back(piece);
  };
  scene.statics.clear();
  for (int column = -6; column <= 6; ++column) {
    for (int row = 0; row <= 6; ++row) {
      add(core::Box{{kTile / 2, kTile / 2, 0.2}}, {kTile * column, kTile * (row + 0.5), -0.2});
    }
  }
  if (moves) {
    const core::Quat none = core::Quat::Identity();
    scene.statics.change(45, [&none](core::StaticBody& tile) {
      tile.path = core::StaticPath{{{0.7, {{0, 0, -0.5}, none}}, {1.4, {{0, 0, 0}, none}}}, false, true};
    });
  }
  core::TriangleMesh mesh;
  for (int row = 0; row < 9; ++row) {
    for (int column = -9; column < 9; ++column) {
      const auto corner = static_cast<std::uint32_t>(mesh.points.size());
      for (int i = 0; i < 4; ++i) mesh.points.push_back(core::Vec3(column + i % 2, row + i / 2 - 9, 0));
      mesh.triangles.push_back({corner, corner + 1, corner + 3});
      mesh.triangles.push_back({corner, corner + 3, corner + 2});
    }
  }
  add(mesh, core::Vec3::Zero());
}

TEST_P(SolverBits, OfFloorsOfPiecesAreThoseOfTheCentralRun) {
  std::uint64_t hand_offs = 0;
  for (int seed = 1; seed <= seeds_or(4); ++seed) {
    core::Scene scene = thrown_bodies(50, 12, 12, 8, static_cast<std::uint64_t>(seed));
    scene.materials[0].friction = 0.2;
    lay_floor(scene, GetParam() == physics::Solver::kSoftStep);
    ClusterOptions options;
    options.map = seed % 2 == 0 ? core::RegionMap::grid(2, 2, kCell, kCell) : core::RegionMap::columns(2, kCell);
    options.sync = core::SyncMode::kDeterministic;
    options.physics.solver = GetParam();
    options.physics.continuous = GetParam() == physics::Solver::kSoftStep;
    options.seed = static_cast<std::uint64_t>(seed);
    options.aura.lookahead = 1 + seed % 2;
    options.aura.top_speed_m_s = 40;
    options.network.loss = 0.05;
    hand_offs += expect_bits_of_central_run(scene, options, 240);
  }
  EXPECT_GT(hand_offs, 0u);
  std::cout << hand_offs << " hand-offs\n";
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverBits,
                         testing::Values(physics::Solver::kSequentialImpulse, physics::Solver::kSoftStep),
                         [](const auto& param) { return std::string(physics::name_of(param.param)); });

}  // namespace
}  // namespace aurasim::test
