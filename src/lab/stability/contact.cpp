// One or a few bodies that touch something.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lab/stability/scene_builder.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

Case sliding_box() {
  constexpr double kFriction = 0.25, kSpeed = 5, kStart = -2;
  const double way = kSpeed * kSpeed / (2 * kFriction * kGravity);
  Case c{"sliding_box", "stops after v0^2 / (2 mu g); v0 = 5 m/s, mu = 0.25", 0, 3};
  SceneBuilder scene(c.name);
  scene.material(kFriction).ground().body(core::Box{{0.5, 0.5, 0.25}}, 1, {kStart, 0, 0.25}, {kSpeed, 0, 0});
  c.scene = scene.scene();
  c.metrics = {{"distance from the place where it should stop", "m", Over::kLast,
                [=](const Moment& now) { return std::abs(now.bodies[0].p_WB.x() - kStart - way); }}};
  return c;
}

Case incline() {
  constexpr double kFriction = 0.25;
  const double slope = std::numbers::pi / 6;
  const double acceleration = kGravity * (std::sin(slope) - kFriction * std::cos(slope));
  const Vec3 normal(std::sin(slope), 0, std::cos(slope));
  const Vec3 down(std::cos(slope), 0, -std::sin(slope));
  const Vec3 start = -3 * down + 0.25 * normal;
  Case c{"incline", "g (sin a - mu cos a) t^2 / 2; a = 30 degrees, mu = 0.25", 0, 2};
  SceneBuilder scene(c.name);
  scene.material(kFriction).fixed(core::Plane{normal, 0});
  scene.body(core::Box{{0.5, 0.5, 0.25}}, 1, start, Vec3::Zero(), Vec3::Zero(),
             core::Quat(Eigen::AngleAxisd(slope, Vec3::UnitY())));
  c.scene = scene.scene();
  c.metrics = {{"distance from where it should be", "m", Over::kLargest, [=](const Moment& now) {
                  return (now.bodies[0].p_WB - start - 0.5 * acceleration * now.t_s * now.t_s * down).norm();
                }}};
  return c;
}

Case bowling_ball() {
  constexpr double kFriction = 0.2, kSpeed = 5, kRadius = 0.11;
  Case c{"bowling_ball", "v0 - mu g t until it rolls at 5/7 v0, at t = 2 v0 / (7 mu g); v0 = 5 m/s, mu = 0.2", 0, 2};
  SceneBuilder scene(c.name);
  scene.material(kFriction).ground().body(core::Sphere{kRadius}, 7, {-3, 0, kRadius}, {kSpeed, 0, 0});
  c.scene = scene.scene();
  c.metrics = {{"|v - v(t)|", "m/s", Over::kLargest,
                [=](const Moment& now) {
                  const double expected = std::max(kSpeed - kFriction * kGravity * now.t_s, 5.0 / 7 * kSpeed);
                  return std::abs(now.bodies[0].v_WB.x() - expected);
                }},
               {"|v - 5/7 v0| / v0 in the end", "1", Over::kLast,
                [=](const Moment& now) { return std::abs(now.bodies[0].v_WB.x() - 5.0 / 7 * kSpeed) / kSpeed; }}};
  return c;
}

constexpr double kDrop_m = 1, kBallRadius_m = 0.5;

SceneBuilder bouncing(const std::string& name, double restitution) {
  SceneBuilder scene(name);
  scene.material(0, restitution).ground().body(core::Sphere{kBallRadius_m}, 1, {-0.1, 0, kBallRadius_m + kDrop_m});
  return scene;
}

Case bouncing_ball() {
  Case c{"bouncing_ball_1", "restitution 1: the energy stays; dropped from 1 m", 0, 20};
  c.scene = bouncing(c.name, 1).scene();
  c.metrics = {{"|E - E0| / E0, velocities of the middle of the step", "1", Over::kLargest, [](const Moment& now) {
                  const core::BodyRecord& ball = now.bodies[0];
                  const double v = ball.v_WB.z() - 0.5 * kGravity * now.step_s * (now.t_s > 0);
                  const double whole = kGravity * kDrop_m;
                  return std::abs(0.5 * v * v + kGravity * (ball.p_WB.z() - kBallRadius_m) - whole) / whole;
                }}};
  return c;
}

/// A cube that falls flat, so four corners bounce at once.
Case bouncing_box() {
  constexpr double kHalf = 0.5;
  Case c{"bouncing_box_1", "restitution 1, no friction: the energy stays; a cube of 1 m dropped flat from 1 m", 0, 5};
  SceneBuilder scene(c.name);
  scene.material(0, 1).ground().body(core::Box{{kHalf, kHalf, kHalf}}, 1, {-0.1, 0, kHalf + kDrop_m});
  c.scene = scene.scene();
  c.metrics = {{"|E - E0| / E0, velocities of the middle of the step", "1", Over::kLargest,
                [scene = c.scene](const Moment& now) {
                  core::BodyRecord box = now.bodies[0];
                  box.v_WB.z() -= 0.5 * kGravity * now.step_s * (now.t_s > 0);
                  const double whole = kGravity * kDrop_m;
                  return std::abs(energy(scene, std::span(&box, 1)) - kGravity * (kHalf + kDrop_m)) / whole;
                }}};
  return c;
}

/// Height of a ball dropped from 1 m, restitution 1/2, at t.
double bounced_height(double t_s) {
  double up = 0;
  double left = t_s - std::sqrt(2 * kDrop_m / kGravity);
  if (left <= 0) return kDrop_m - 0.5 * kGravity * t_s * t_s;
  for (up = 0.5 * std::sqrt(2 * kDrop_m * kGravity); left > 2 * up / kGravity && up > 1e-6; up /= 2) {
    left -= 2 * up / kGravity;
  }
  return up > 1e-6 ? up * left - 0.5 * kGravity * left * left : 0;
}

Case bouncing_ball_half() {
  Case c{"bouncing_ball_0.5", "restitution 0.5: parabolas, each a quarter as high; dropped from 1 m", 0, 2};
  c.scene = bouncing(c.name, 0.5).scene();
  c.metrics = {{"distance from where it should be", "m", Over::kLargest, [](const Moment& now) {
                  return std::abs(now.bodies[0].p_WB.z() - kBallRadius_m - bounced_height(now.t_s));
                }}};
  return c;
}

/// Gravity leans, so everything rolls along x: 25 balls of 1 kg on the ground, a plate of 10 kg on them.
Case rolling_plate(const std::string& name, double erp) {
  constexpr double kAlong = 1, kPlate = 10, kBalls = 25;
  const double acceleration = kAlong * (2 * kPlate + kBalls) / (4 * kPlate + 1.4 * kBalls);
  Case c{name, "balls v = g_x (2M + nm) / (4M + 7/5 nm) t, plate 2v (after Hwangbo's SimBenchmark, rolling test)", 0,
         1.5};
  c.contact_erp = erp;
  SceneBuilder scene(name, {kAlong, 0, -kGravity});
  scene.material(1).ground();
  for (int i = 0; i < 25; ++i) scene.body(core::Sphere{0.5}, 1, {2.0 * (i % 5) - 4.5, 2.0 * (i / 5) - 4, 0.5});
  scene.body(core::Box{{7, 7, 0.25}}, kPlate, {-0.5, 0, 1.25});
  c.scene = scene.scene();
  c.metrics = {{"mean squared velocity error", "m^2/s^2", Over::kMean, [=](const Moment& now) {
                  double sum = 0;
                  for (const core::BodyRecord& body : now.bodies) {
                    const double factor = &body == &now.bodies.back() ? 2 : 1;
                    sum += (body.v_WB - Vec3(factor * acceleration * now.t_s, 0, 0)).squaredNorm();
                  }
                  return sum / static_cast<double>(now.bodies.size());
                }}};
  return c;
}

/// A ball of 1 cm at 300 m/s against 0.1 mm of something that does not give way.
Case bullet(const std::string& name, bool continuous) {
  constexpr double kRadius = 0.01;
  Case c{name, "it does not get through", 0, 0.1};
  c.continuous = continuous;
  SceneBuilder scene(name, Vec3::Zero());
  scene.fixed(core::Box{{0.00005, 1, 1}}, {Vec3(0, 0, 1), core::Quat::Identity()});
  scene.body(core::Sphere{kRadius}, 0.01, {-7.3, 0, 1}, {300, 0, 0});
  c.scene = scene.scene();
  c.metrics = {{"how far it got beyond the paper", "m", Over::kLargest,
                [](const Moment& now) { return std::max(0.0, now.bodies[0].p_WB.x()); }}};
  return c;
}

/// A box slides down a prism that slides away beneath it, without friction.
Case wedge() {
  constexpr double kBase = 4, kPrism = 4, kBox = 1, kHalf = 0.25;
  const double slope = std::numbers::pi / 6;
  const double height = kBase * std::tan(slope);
  const double s = std::sin(slope), k = std::cos(slope);
  const double back = kBox * kGravity * s * k / (kPrism + kBox * s * s);
  const double along = (kPrism + kBox) * kGravity * s / (kPrism + kBox * s * s);
  core::ConvexHull prism;
  for (const double y : {-1.0, 1.0}) {
    for (const auto& [x, z] : {std::pair(0.0, 0.0), std::pair(kBase, 0.0), std::pair(0.0, height)}) {
      prism.points.push_back({x - kBase / 3, y, z - height / 3});
    }
  }
  const Vec3 top(-1, 0, height);  // of the slope; the prism lies across the border
  const Vec3 start = top + Vec3(0.6 * k + kHalf * s, 0, -0.6 * s + kHalf * k);
  Case c{"wedge", "a box on a free prism, no friction: m g sin a cos a / (M + m sin^2 a); a = 30 degrees, 1 kg on 4 kg",
         0, 0.8};
  SceneBuilder scene(c.name);
  scene.ground().body(prism, kPrism, {-1 + kBase / 3, 0, height / 3});
  scene.body(core::Box{{kHalf, kHalf, kHalf}}, kBox, start, Vec3::Zero(), Vec3::Zero(),
             core::Quat(Eigen::AngleAxisd(slope, Vec3::UnitY())));
  c.scene = scene.scene();
  c.metrics = {{"distance of the prism from where it should be", "m", Over::kLargest,
                [=](const Moment& now) {
                  return std::abs(now.bodies[0].p_WB.x() + 1 - kBase / 3 + 0.5 * back * now.t_s * now.t_s);
                }},
               {"distance of the box from where it should be", "m", Over::kLargest, [=](const Moment& now) {
                  const Vec3 a(along * k - back, 0, -along * s);
                  return (now.bodies[1].p_WB - start - 0.5 * now.t_s * now.t_s * a).norm();
                }}};
  return c;
}

Case deep_overlap() {
  Case c{"deep_overlap", "two boxes half inside each other come apart without being shot away", 0, 3};
  SceneBuilder scene(c.name, Vec3::Zero());
  for (const double x : {-0.25, 0.25}) scene.body(core::Box{{0.5, 0.5, 0.5}}, 1, {x, 0, 5});
  c.scene = scene.scene();
  c.metrics = {{"speed at which they part", "m/s", Over::kLargest,
                [](const Moment& now) { return (now.bodies[0].v_WB - now.bodies[1].v_WB).norm(); }}};
  return c;
}

}  // namespace

std::vector<Case> contact_cases() {
  return {sliding_box(),
          incline(),
          bowling_ball(),
          bouncing_ball(),
          bouncing_ball_half(),
          bouncing_box(),
          rolling_plate("rolling_plate", 0.2),
          rolling_plate("rolling_plate_no_erp", 0),
          bullet("bullet_ccd_off", false),
          bullet("bullet_ccd_on", true),
          wedge(),
          deep_overlap()};
}

}  // namespace aurasim::lab
