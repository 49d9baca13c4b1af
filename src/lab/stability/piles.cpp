// Many bodies on each other, which should stay where they are.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lab/pair.h"
#include "lab/stability/scene_builder.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

constexpr double kFriction = 0.36;
constexpr double kWatched_s = 5;

Case standing(const std::string& name, const std::string& what, const SceneBuilder& scene, double drop_m) {
  Case c{name, what + "; it stands", 0, kWatched_s};
  c.scene = scene.scene();
  c.metrics = {drift(c.scene), fallen(c.scene, drop_m), sunk(c.scene)};
  return c;
}

core::Box cube(double side_m) { return {Vec3::Constant(side_m / 2)}; }

Case stack(int count) {
  const std::string name = "stack_" + std::to_string(count);
  SceneBuilder scene(name);
  scene.material(kFriction).ground();
  for (int i = 0; i < count; ++i) scene.body(cube(1), 1, {0.1, 0, 0.5 + i});
  return standing(name, "cubes of 1 m, 1 kg", scene, 0.5);
}

/// `side_m` m cubes, each of the mass of the one of 1 m.
Case stack_of_five(const std::string& name, double side_m, double x_m) {
  SceneBuilder scene(name);
  scene.material(kFriction).ground();
  for (int i = 0; i < 5; ++i) scene.body(cube(side_m), 1, {x_m + 0.1 * side_m, 0, side_m * (0.5 + i)});
  Case c = standing(name, "five cubes, 1 kg", scene, 0.5 * side_m);
  c.border_x_m = x_m;
  return c;
}

Case pyramid() {
  constexpr int kRows = 15;
  SceneBuilder scene("pyramid");
  scene.material(kFriction).ground();
  for (int row = 0; row < kRows; ++row) {
    for (int i = 0; i < kRows - row; ++i) scene.body(cube(1), 1, {1.1 * (i - (kRows - row - 1) / 2.0), 0, 0.5 + row});
  }
  return standing("pyramid", "15 rows of cubes of 1 m", scene, 0.5);
}

/// Three storeys of cards of 1.0 x 0.7 x 0.03 m that lean by 17 degrees, friction 0.8. Cards that lie end above the
/// ridge between two pairs, and overhang outside.
Case card_house() {
  constexpr double kThick = 0.03, kSpan = 0.681, kHalfFoot = 0.161, kOverhang = 0.15, kGap = 0.0005;
  const double lean = 17 * std::numbers::pi / 180;
  const double up = std::cos(lean) + kThick * std::sin(lean);  // height of a leaning card
  const double storey = up + kThick + 2 * kGap;
  SceneBuilder scene("card_house");
  scene.material(0.81).ground();
  for (int level = 0; level < 3; ++level) {
    const int pairs = 3 - level;
    const auto ridge_x = [&](int i) { return kSpan * (i - (pairs - 1) / 2.0); };
    for (int i = 0; i < pairs; ++i) {
      for (const double side : {-1.0, 1.0}) {
        scene.body(core::Box{{kThick / 2, 0.35, 0.5}}, 0.2, {ridge_x(i) + side * kHalfFoot, 0, level * storey + up / 2},
                   Vec3::Zero(), Vec3::Zero(), core::Quat(Eigen::AngleAxisd(-side * lean, Vec3::UnitY())));
      }
      if (i == 0) continue;
      const double left = ridge_x(i - 1) + (i == 1 ? -kOverhang : 2 * kGap);
      const double right = ridge_x(i) + (i == pairs - 1 ? kOverhang : -2 * kGap);
      scene.body(core::Box{{(right - left) / 2, 0.35, kThick / 2}}, 0.2,
                 {(left + right) / 2, 0, level * storey + up + kGap + kThick / 2});
    }
  }
  return standing("card_house", "three storeys, 15 cards", scene, 0.2);
}

/// A cube `ratio` times as heavy on five others.
Case mass_ratio(int ratio) {
  const std::string name = "mass_ratio_" + std::to_string(ratio);
  SceneBuilder scene(name);
  scene.material(kFriction).ground();
  for (int i = 0; i < 6; ++i) scene.body(cube(1), i < 5 ? 1 : ratio, {0.1, 0, 0.5 + i});
  return standing(name, "a cube on five that are " + std::to_string(ratio) + " times lighter", scene, 0.5);
}

double deepest_overlap(std::span<const core::BodyRecord> balls, double radius_m) {
  double deepest = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    deepest = std::max(deepest, radius_m - balls[i].p_WB.z());
    for (std::size_t j = 0; j < i; ++j) {
      deepest = std::max(deepest, 2 * radius_m - (balls[i].p_WB - balls[j].p_WB).norm());
    }
  }
  return deepest;
}

/// Elastic balls without friction.
Case balls() {
  constexpr int kBalls = 666, kAcross = 9;
  constexpr double kRadius = 0.3, kApart = 0.8;
  Case c{"balls_666", "elastic, no friction: the energy stays (after Hwangbo's SimBenchmark, 666 balls)", 666, 2};
  c.uncertainty = 1;
  Chance chance(c.seed);
  const auto jitter = [&] { return 0.1 * (chance.between(0, 1) - 0.5); };
  SceneBuilder scene(c.name);
  scene.material(0, 1).ground();
  for (int i = 0; i < kBalls; ++i) {
    const double x = kApart * (i % kAcross - kAcross / 2) + jitter();
    const double y = kApart * (i / kAcross % kAcross - kAcross / 2) + jitter();
    scene.body(core::Sphere{kRadius}, 1, {x, y, 1 + kApart * (i / (kAcross * kAcross)) + jitter()});
  }
  c.scene = scene.scene();
  c.metrics = {{"|E - E0| / E0, in the end", "1", Over::kLast,
                [scene = c.scene](const Moment& now) {
                  std::vector<core::BodyRecord> first;
                  for (const core::InitialBody& body : scene.bodies) first.push_back(core::initial_record(body));
                  const double before = energy(scene, first);
                  return std::abs(energy(scene, now.bodies) - before) / before;
                }},
               {"deepest overlap, mean over the states", "m", Over::kMean,
                [](const Moment& now) { return deepest_overlap(now.bodies, kRadius); }}};
  return c;
}

}  // namespace

std::vector<Case> pile_cases() {
  std::vector<Case> cases;
  for (const int count : {5, 10, 20, 50}) cases.push_back(stack(count));
  cases.push_back(pyramid());
  cases.push_back(card_house());
  for (const int ratio : {100, 1000}) cases.push_back(mass_ratio(ratio));
  cases.push_back(balls());
  cases.push_back(stack_of_five("far_100km", 1, 100'000));
  cases.push_back(stack_of_five("tiny_1cm", 0.01, 0));
  cases.push_back(stack_of_five("huge_100m", 100, 0));
  return cases;
}

}  // namespace aurasim::lab
