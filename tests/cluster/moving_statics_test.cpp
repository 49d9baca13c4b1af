// Lifts, gates, turnstiles and belts on borders of whole simulated clusters: the same bits as in one world, also where
// a hand-off is late, and nobody is lost who is pushed across a border.
#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"

namespace aurasim::test::moving {
namespace {

using core::Quat;
using core::Step;
using core::Vec3;

constexpr Step kSteps = 400;

Quat yaw(double rad) { return Quat(Eigen::AngleAxisd(rad, Vec3::UnitZ())); }

void add_box(core::Scene& scene, const Vec3& half_extents, const Vec3& p, std::optional<core::StaticPath> path,
             const Vec3& belt = Vec3::Zero()) {
  scene.shapes.push_back({"box", core::Box{half_extents}});
  core::StaticBody body;
  body.name = "mover " + std::to_string(scene.statics.size() + 1);
  body.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  body.pose.p_WB = p;
  body.path = std::move(path);
  body.belt_S = belt;
  scene.statics.push_back(body);
}

/// Where regions meet.
void add_movers(core::Scene& scene) {
  const Quat none = Quat::Identity();
  add_box(scene, {3, 3, 0.3}, {0, 0, 0.1}, {{{{1, {{0, 0, 2}, none}}, {2, {{0, 0, 0}, none}}}, true, true}});
  add_box(scene, {0.3, 4, 1}, {-2, -6, 1.1}, {{{{1.5, {{4, 0, 0}, none}}, {3, {{0, 0, 0}, none}}}, true, false}});
  add_box(scene, {3, 0.2, 0.6}, {0, 6, 0.7},
          {{{{1, {Vec3::Zero(), yaw(2)}}, {2, {Vec3::Zero(), yaw(4)}}, {3, {Vec3::Zero(), none}}}, true, false}});
  add_box(scene, {6, 1.5, 0.2}, {0, -12, 0.2}, std::nullopt, {3, 0, 0});
  add_box(scene, {1.5, 6, 0.2}, {-6, 0, 0.2}, std::nullopt, {0, -2, 0});
}

/// The belts are sent away in the middle of the run, and one of them comes back.
std::vector<std::pair<Step, core::Action>> moves_for(const core::Scene& scene) {
  const auto last = static_cast<std::uint32_t>(scene.statics.size() - 1);
  const Quat none = Quat::Identity();
  return {{150, core::MoveStatic{core::StaticId{last}, {}, {{0, 0, 1.5}, yaw(1)}, 90}},
          {170, core::MoveStatic{core::StaticId{last - 1}, {}, {{2, -8, 0.4}, none}, 40}},
          {280, core::MoveStatic{core::StaticId{last}, {}, scene.statics[last].pose, 60}}};
}

class MovingStaticsCluster : public testing::TestWithParam<bool> {};  ///< with redo

TEST_P(MovingStaticsCluster, HasTheSameBitsAsOneWorld) {
  std::uint64_t hand_offs = 0;
  for (int seed = 1; seed <= seeds_or(6); ++seed) {
    core::Scene scene = thrown_bodies(60, 1.2 * kCell, 1.2 * kCell, 5, static_cast<std::uint64_t>(seed));
    add_movers(scene);
    ClusterOptions options;
    options.map = core::RegionMap::grid(static_cast<std::size_t>(seed % 2 + 1), 2, kCell, kCell);
    options.seed = static_cast<std::uint64_t>(seed);
    options.sync = core::SyncMode::kDeterministic;
    options.physics.solver = physics::Solver::kSoftStep;
    options.aura.lookahead = 1 + seed % 3;
    options.aura.top_speed_m_s = 40;
    options.aura.redo = GetParam();
    options.network.loss = 0.05;
    options.network.latency_s = 0.004 * (seed % 4);
    options.network.jitter_s = 0.006;
    if (seed % 2 == 0) options.orders = moves_for(scene);
    const Outcome many = CheckedRun(scene, options).run(kSteps);
    options.map = core::RegionMap::columns(1, 1);
    options.aura.redo = false;
    const Outcome one = CheckedRun(scene, options).run(kSteps);
    EXPECT_EQ(first_difference(many, one), kSteps + 1) << "seed " << seed;
    EXPECT_EQ(many.lost + many.doubled + many.severed + many.bad_phases, 0u) << "seed " << seed;
    EXPECT_EQ(many.late + many.missed, 0u) << "seed " << seed;
    hand_offs += many.hand_offs;
  }
  EXPECT_GT(hand_offs, 100u);
}

INSTANTIATE_TEST_SUITE_P(, MovingStaticsCluster, testing::Bool(),
                         [](const auto& info) { return info.param ? "Redone" : "SureBeforehand"; });

}  // namespace
}  // namespace aurasim::test::moving
