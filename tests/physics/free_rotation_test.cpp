// A body that nothing acts on keeps its angular momentum and its energy.
#include "physics/free_rotation.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

/// The box of the Dzhanibekov case: 10 kg, 0.1 x 0.4 x 0.9 m.
const Vec3 kInertia(0.80833333333333333, 0.68333333333333333, 0.14166666666666667);
const Vec3 kSpin(0.1, 5, 0.1);

Vec3 momentum(const core::Mat3& R_WB, const Vec3& w_WB) {
  return R_WB * kInertia.cwiseProduct(R_WB.transpose() * w_WB);
}
double energy(const core::Mat3& R_WB, const Vec3& w_WB) { return 0.5 * w_WB.dot(momentum(R_WB, w_WB)); }

struct Errors {
  double momentum = 0;  ///< largest |L - L0| / |L0|
  double energy = 0;    ///< largest |E - E0| / E0
  bool flipped = false;
};

/// In 10 s of weightlessness.
Errors tumble(int step_hz, int substeps) {
  core::Scene scene = scene_of(core::Box{{0.05, 0.2, 0.45}});
  scene.gravity = Vec3::Zero();
  scene.statics.clear();
  scene.materials[0] = {};
  scene.prototypes[0].mass_kg = 10;
  scene.prototypes[0].can_sleep = false;
  Settings settings;
  settings.step_s = 1.0 / step_hz;
  settings.substeps = substeps;
  RegionWorld world(scene, settings);
  core::BodyRecord box = body(1, 0, Vec3::Zero());
  box.w_WB = kSpin;
  world.add({&box, 1});
  const Vec3 L0 = momentum(box.R_WB, box.w_WB);
  const double E0 = energy(box.R_WB, box.w_WB);
  Errors errors;
  for (int i = 0; i < 10 * step_hz; ++i) {
    world.step();
    const core::BodyRecord& now = world.records().front();
    errors.momentum = std::max(errors.momentum, (momentum(now.R_WB, now.w_WB) - L0).norm() / L0.norm());
    errors.energy = std::max(errors.energy, std::abs(energy(now.R_WB, now.w_WB) - E0) / E0);
    errors.flipped = errors.flipped || (now.R_WB.transpose() * now.w_WB).y() < -4.5;
  }
  return errors;
}

TEST(FreeRotation, ATumblingBoxKeepsItsMomentumAndItsEnergy) {
  for (const auto& [step_hz, substeps] : {std::pair(60, 1), std::pair(60, 4), std::pair(240, 1), std::pair(1000, 1)}) {
    const Errors errors = tumble(step_hz, substeps);
    EXPECT_LT(errors.momentum, 1e-3) << step_hz;
    EXPECT_LT(errors.energy, 1e-2) << step_hz;
    EXPECT_TRUE(errors.flipped) << "Dzhanibekov: turning about the middle axis is unstable";
    std::cout << step_hz << " Hz x " << substeps << ": momentum " << errors.momentum << ", energy " << errors.energy
              << "\n";
  }
}

TEST(FreeRotation, ASymmetricTopPrecessesAsItShould) {
  const Vec3 inertia(0.2, 0.2, 0.05);
  Rotation top{core::Mat3::Identity(), Vec3(1, 0, 20)};
  const Vec3 L = inertia.cwiseProduct(top.w_WB);
  constexpr double kStep = 1.0 / 60;
  for (int i = 1; i <= 600; ++i) {
    top = rotate_freely(top, inertia, kStep);
    const Eigen::AngleAxisd precession(L.norm() / inertia.x() * kStep * i, L.normalized());
    ASSERT_LT((top.R_WB.col(2) - precession * Vec3::UnitZ()).norm(), 0.02) << i;
  }
}

TEST(FreeRotation, BallsAndCubesTurnEvenly) {
  EXPECT_TRUE(turns_evenly(Vec3::Constant(0.3)));
  EXPECT_TRUE(turns_evenly(Vec3(0.3, 0.3 * (1 + 1e-8), 0.3)));
  EXPECT_FALSE(turns_evenly(kInertia));
}

TEST(FreeRotation, ABodyThatIsHandedOverTumblesOnWithTheSameBits) {
  core::Scene scene = scene_of(core::Box{{0.05, 0.2, 0.45}});
  core::BodyRecord box = body(1, 0, {0, 0, 200});
  box.w_WB = kSpin;
  RegionWorld untouched(scene, Settings{});
  RegionWorld first(scene, Settings{});
  RegionWorld second(scene, Settings{});
  untouched.add({&box, 1});
  first.add({&box, 1});
  run(untouched, 60);
  run(first, 30);
  const core::ClusterState cluster = first.release(std::vector{box.id});
  run(second, 37);
  second.adopt(cluster, 30);  // seven steps late
  run(second, 23);
  EXPECT_TRUE(different(second.records(), untouched.records()).empty());
}

}  // namespace
}  // namespace aurasim::physics::testing
