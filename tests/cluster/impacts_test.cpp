// A body that is hit hits the next: who is faster than it seemed a moment ago, because of what a body of another node
// has done to it, was promised to be slower. What comes of that is computed again, and has the bits of one world.
#include <cstdint>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"

namespace aurasim::test {
namespace {

using core::Vec3;

constexpr double kBall_m = 0.3;
constexpr core::PrototypeId kBall{0}, kBar{1}, kLightBall{2}, kHeavyBall{3};

/// Weightless, so that nothing but impacts moves what rests.
class ImpactScene {
 public:
  explicit ImpactScene(std::uint64_t seed) : random_(seed) {
    scene_.name = "impacts";
    scene_.gravity = Vec3::Zero();
    scene_.shapes = {{"ball", core::Sphere{kBall_m}}, {"bar", core::Capsule{0.15, 1.7}}};
    core::Material material;
    material.restitution = seed % 2 == 0 ? 0 : 0.5;
    scene_.materials = {material};
    scene_.prototypes = {{"ball", 0, 0, 1, true},
                         {"bar", 1, 0, 1, true},
                         {"light ball", 0, 0, 0.2, true},
                         {"heavy ball", 0, 0, 5, true}};
  }

  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }
  bool chance() { return random_() % 2 == 0; }

  core::InitialBody& put(core::PrototypeId kind, const Vec3& p) {
    core::InitialBody body;
    body.id = core::BodyId{scene_.bodies.size()};
    body.prototype = kind;
    body.pose.p_WB = p;
    return scene_.bodies.emplace_back(body);
  }
  const core::Scene& scene() const { return scene_; }

 private:
  std::mt19937_64 random_;
  core::Scene scene_;
};

/// Balls in a row over the border, a little apart; another one flies into one end of it, some when all are asleep.
void add_row(ImpactScene& scene, double y_m) {
  const double side = scene.chance() ? 1 : -1;
  double x = -2.5;
  while (x < 2.5) {
    scene.put(kBall, {side * x, y_m, 0});
    x += 2 * kBall_m + scene.between(0.04, 0.3);
  }
  const double speed = scene.between(4, 16);
  const double flight_s = scene.between(0.2, 3.5);
  scene.put(scene.chance() ? kHeavyBall : kBall, {-side * (3.5 + speed * flight_s), y_m, 0}).v_WB = {side * speed, 0,
                                                                                                     0};
}

/// A bar that turns on the spot, and balls that its ends throw over the border, or at other balls there.
void add_spinner(ImpactScene& scene, double y_m) {
  core::InitialBody& bar = scene.put(kBar, {scene.between(-1.2, 1.2), y_m, 0});
  bar.pose.q_WB = core::Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()));
  bar.w_WB = {0, 0, (scene.chance() ? 1 : -1) * scene.between(5, 25)};
  bar.v_WB = {scene.between(-0.2, 0.2), scene.between(-0.2, 0.2), 0};
  const Vec3 centre = bar.pose.p_WB;
  const double from = scene.between(0, 2 * std::numbers::pi);
  for (int i = 0; i < 6; ++i) {
    const double turn = from + i * std::numbers::pi / 3;
    const double away_m = 1.5 + scene.between(0, 0.8) + (i % 2) * 0.7;
    scene.put(scene.chance() ? kLightBall : kBall, centre + away_m * Vec3(std::cos(turn), std::sin(turn), 0));
  }
}

class Impacts : public testing::Test {
 protected:
  void run(const ImpactScene& impacts, std::uint64_t seed, core::Step steps) {
    const core::Scene& scene = impacts.scene();
    ClusterOptions options;
    options.map = core::RegionMap::columns(2, 100);
    options.sync = core::SyncMode::kDeterministic;
    options.seed = seed;
    options.aura.lookahead = static_cast<int>(1 + seed % 3);
    options.aura.substeps = 4;
    options.aura.top_speed_m_s = 60;
    options.aura.redo = true;
    options.aura.gravity = scene.gravity;
    const Outcome o = CheckedRun(scene, options).run(steps);
    EXPECT_EQ(o.lost + o.doubled, 0u) << "seed " << seed;
    EXPECT_EQ(o.hash, run_central(scene, options, steps).hash) << "seed " << seed;
    hand_offs_ += o.hand_offs;
  }

  std::uint64_t hand_offs_ = 0;
};

TEST_F(Impacts, GoThroughARowAcrossTheBorder) {
  for (int seed = 1; seed <= seeds_or(6); ++seed) {
    ImpactScene scene(static_cast<std::uint64_t>(seed));
    for (int row = 0; row < 12; ++row) add_row(scene, 4.0 * row - 24);
    run(scene, static_cast<std::uint64_t>(seed), 300);
  }
  EXPECT_GT(hand_offs_, 0u);
}

TEST_F(Impacts, MayComeFromABodyThatOnlyTurns) {
  for (int seed = 1; seed <= seeds_or(6); ++seed) {
    ImpactScene scene(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < 12; ++i) add_spinner(scene, 7.0 * i - 42);
    run(scene, static_cast<std::uint64_t>(seed), 240);
  }
  EXPECT_GT(hand_offs_, 0u);
}

}  // namespace
}  // namespace aurasim::test
