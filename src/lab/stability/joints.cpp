// Bodies held together.
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "lab/stability/scene_builder.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

core::Pose at(const Vec3& p_W) { return {p_W, core::Quat::Identity()}; }

double initial_energy(const core::Scene& scene) {
  std::vector<core::BodyRecord> first;
  for (const core::InitialBody& body : scene.bodies) first.push_back(core::initial_record(body));
  return energy(scene, first);
}

/// Five balls, each on two strings, 0.1 m apart; the first is lifted by 45 degrees.
Case newtons_cradle() {
  constexpr double kString = 3, kRadius = 0.5, kMass = 10;
  const double lift = std::numbers::pi / 4;
  Case c{"newtons_cradle", "elastic: the energy stays; 5 balls of 10 kg on strings of 3 m, lifted by 45 degrees", 0, 8};
  c.uncertainty = 1;
  SceneBuilder scene(c.name);
  scene.material(0, 1);
  for (int i = 0; i < 5; ++i) {
    const double x = 1.1 * (i - 2);
    const double angle = i == 0 ? lift : 0;
    const core::BodyId ball =
        scene.body(core::Sphere{kRadius}, kMass, {x - kString * std::sin(angle), 0, 4 - kString * std::cos(angle)});
    for (const double y : {-1.5, 1.5}) scene.joint(core::BallJoint{}, ball, std::nullopt, at({x, y, 4}));
  }
  c.scene = scene.scene();
  const double swing = kMass * kGravity * kString * (1 - std::cos(lift));
  c.metrics = {{"|E - E0| / energy of the lifted ball", "1", Over::kLargest,
                [scene = c.scene, E0 = initial_energy(c.scene), swing](const Moment& now) {
                  return std::abs(energy(scene, now.bodies) - E0) / swing;
                }}};
  return c;
}

constexpr double kRod_m = 1, kRodWidth_m = 0.1, kReference_s = 1e-5;

using Angles = Eigen::Vector4d;  ///< of both rods from hanging down, and their rates

/// Lagrange's equations of two even rods of 1 kg in a plane.
Angles derivative(const Angles& s) {
  const double inertia = (kRod_m * kRod_m + kRodWidth_m * kRodWidth_m) / 12;
  const double half = kRod_m * kRod_m / 2;
  const double sine = std::sin(s[0] - s[1]), cosine = std::cos(s[0] - s[1]);
  Eigen::Matrix2d mass;
  mass << inertia + kRod_m * kRod_m * 1.25, half * cosine, half * cosine, inertia + kRod_m * kRod_m / 4;
  const Eigen::Vector2d force(-half * sine * s[3] * s[3] - 1.5 * kGravity * kRod_m * std::sin(s[0]),
                              half * sine * s[2] * s[2] - 0.5 * kGravity * kRod_m * std::sin(s[1]));
  const Eigen::Vector2d acceleration = mass.inverse() * force;
  return {s[2], s[3], acceleration[0], acceleration[1]};
}

/// Both rods start level. Angles at multiples of kReference_s.
std::vector<Eigen::Vector2d> reference_swing(double duration_s) {
  Angles s(std::numbers::pi / 2, std::numbers::pi / 2, 0, 0);
  std::vector<Eigen::Vector2d> swing = {s.head<2>()};
  const double h = kReference_s;
  while (static_cast<double>(swing.size()) * h <= duration_s + 1) {
    const Angles k1 = derivative(s), k2 = derivative(s + h / 2 * k1), k3 = derivative(s + h / 2 * k2),
                 k4 = derivative(s + h * k3);
    s += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    swing.push_back(s.head<2>());
  }
  return swing;
}

Vec3 tip_of(const Eigen::Vector2d& angles, const Vec3& pivot) {
  const auto along = [](double a) { return Vec3(std::sin(a), 0, -std::cos(a)); };
  return pivot + kRod_m * along(angles[0]) + 0.5 * kRod_m * along(angles[1]);
}

Case double_pendulum() {
  Case c{"double_pendulum",
         "Lagrange's equations, Runge-Kutta of order 4, step 10 us; two rods of 1 m, 1 kg, from level", 0, 2};
  const Vec3 pivot(-0.3, 0, 5);
  const core::Quat level(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()));
  const core::Quat hinge_y(Eigen::AngleAxisd(-std::numbers::pi / 2, Vec3::UnitX()));
  SceneBuilder scene(c.name);
  const core::Box rod{{kRodWidth_m / 2, kRodWidth_m / 2, kRod_m / 2}};
  const core::BodyId upper = scene.body(rod, 1, pivot + Vec3(0.5, 0, 0), Vec3::Zero(), Vec3::Zero(), level);
  const core::BodyId lower = scene.body(rod, 1, pivot + Vec3(1.5, 0, 0), Vec3::Zero(), Vec3::Zero(), level);
  scene.joint(core::HingeJoint{}, upper, std::nullopt, {pivot, hinge_y});
  scene.joint(core::HingeJoint{}, lower, upper, {pivot + Vec3(1, 0, 0), hinge_y});
  c.scene = scene.scene();
  const auto reference = std::make_shared<const std::vector<Eigen::Vector2d>>(reference_swing(c.duration_s));
  const double scale = kGravity * 2 * kRod_m;  // J: the rods hanging down
  c.metrics = {{"distance of the lower rod from where it should be", "m", Over::kLargest,
                [=](const Moment& now) {
                  const auto index = static_cast<std::size_t>(std::lround(now.t_s / kReference_s));
                  return (now.bodies[1].p_WB - tip_of(reference->at(index), pivot)).norm();
                }},
               {"|E - E0| / energy of falling down", "1", Over::kLargest,
                [scene = c.scene, E0 = initial_energy(c.scene), scale](const Moment& now) {
                  return std::abs(energy(scene, now.bodies) - E0) / scale;
                }}};
  return c;
}

/// 50 links on ball joints, the first to the world, from level.
Case chain() {
  constexpr int kLinks = 50;
  constexpr double kPitch = 0.2;
  Case c{"chain_50", "joints hold: the gap at each is 0; 50 links of 0.2 m, 1 kg, from level", 0, 3};
  const core::Quat level(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()));
  SceneBuilder scene(c.name);
  std::optional<core::BodyId> before;
  for (int i = 0; i < kLinks; ++i) {
    const double x = -5 + kPitch * (i + 0.5);
    const core::BodyId link = scene.body(core::Capsule{0.05, 0.1}, 1, {x, 0, 12}, Vec3::Zero(), Vec3::Zero(), level);
    scene.joint(core::BallJoint{}, link, before, at({x - kPitch / 2, 0, 12}));
    before = link;
  }
  c.scene = scene.scene();
  c.metrics = {{"widest gap at a joint", "m", Over::kLargest, [](const Moment& now) {
                  double widest = 0;
                  for (std::size_t i = 0; i < now.bodies.size(); ++i) {
                    const auto end = [&](std::size_t link, double side) {
                      return Vec3(now.bodies[link].p_WB + side * kPitch / 2 * now.bodies[link].R_WB.col(2));
                    };
                    const Vec3 held = i == 0 ? Vec3(-5, 0, 12) : end(i - 1, 1);
                    widest = std::max(widest, (end(i, -1) - held).norm());
                  }
                  return widest;
                }}};
  return c;
}

}  // namespace

std::vector<Case> joint_cases() { return {newtons_cradle(), double_pendulum(), chain()}; }

std::vector<Case> stability_cases() {
  std::vector<Case> all;
  for (const auto& some : {flight_cases(), contact_cases(), pile_cases(), joint_cases()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

Case stability_case(const std::string& name) {
  for (const Case& c : stability_cases()) {
    if (c.name == name) return c;
  }
  throw std::invalid_argument("there is no case \"" + name + "\"");
}

}  // namespace aurasim::lab
