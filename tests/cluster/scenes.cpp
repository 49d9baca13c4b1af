#include "cluster/scenes.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

namespace aurasim::test {

using core::Vec3;

core::Scene thrown_bodies(std::size_t count, double width_x_m, double width_y_m, double speed_m_s, std::uint64_t seed) {
  core::Scene scene;
  scene.name = "thrown_bodies";
  scene.shapes = {{"box", core::Box{{0.3, 0.3, 0.5}}},
                  {"sphere", core::Sphere{0.4}},
                  {"capsule", core::Capsule{0.3, 0.6}},
                  {"ground", core::Plane{}}};
  core::Material material;
  material.rolling_friction = 0.02;
  material.linear_damping = 0.05;
  material.angular_damping = 0.3;
  scene.materials = {material};
  scene.prototypes = {{"box", 0, 0, 1, true}, {"sphere", 1, 0, 1, true}, {"capsule", 2, 0, 1, true}};
  scene.statics = {{"ground", 3, 0, {}}};
  std::mt19937_64 random(seed);
  const auto u = [&random] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  const std::size_t injected = count / 10;
  for (std::size_t i = 0; i < count - injected; ++i) {
    core::InitialBody body;
    body.id = core::BodyId{i};
    body.prototype = core::PrototypeId{static_cast<std::uint32_t>(random() % 3)};
    body.pose.p_WB = {0.5 * width_x_m * u(), 0.5 * width_y_m * u(), 6 + 5 * u()};
    body.v_WB = {speed_m_s * u(), speed_m_s * u(), 3 * u()};
    scene.bodies.push_back(body);
  }
  core::Injector injector;
  injector.name = "rain";
  injector.seed = seed;
  injector.first_id = core::BodyId{count};
  injector.max_bodies = injected;
  injector.rate_per_s = 20;
  injector.volume_min = {-0.5 * width_x_m, -0.5 * width_y_m, 4};
  injector.volume_max = {0.5 * width_x_m, 0.5 * width_y_m, 12};
  injector.velocity_min = {-speed_m_s, -speed_m_s, -3};
  injector.velocity_max = {speed_m_s, speed_m_s, 3};
  injector.random_orientation = true;
  injector.prototypes = {core::PrototypeId{0}, core::PrototypeId{1}, core::PrototypeId{2}};
  scene.injectors = {injector};
  return scene;
}

core::Scene driven_pairs(std::size_t count, double width_x_m, double width_y_m, double speed_m_s, std::uint64_t seed) {
  core::Scene scene = thrown_bodies(count, width_x_m, width_y_m, speed_m_s, seed);
  core::HingeJoint endless;
  endless.drive = core::JointDrive{.speed = 12, .damping = 0.3, .max_effort = 3};
  core::HingeJoint stiff{core::JointLimits{-7, 30}, {}};
  stiff.drive = core::JointDrive{.position = 8, .stiffness = 500, .damping = 10, .max_effort = 6};
  core::SliderJoint slider;
  slider.resistance = {.stiffness = 50, .rest = 0.4, .damping = 0.5, .friction = 2};
  const core::JointKind kinds[] = {endless, stiff, slider, core::BallJoint{0.1}};
  for (std::size_t i = 0; i + 1 < scene.bodies.size(); i += 2) {
    const core::InitialBody& a = scene.bodies[i];
    core::InitialBody& b = scene.bodies[i + 1];
    b.pose.p_WB = a.pose.p_WB + Vec3(1.2, 0, 0);
    b.v_WB = a.v_WB;
    core::JointSpec joint;
    joint.name = "joint " + std::to_string(i);
    joint.kind = kinds[i / 2 % 4];
    joint.a = a.id, joint.b = b.id;
    joint.X_WJ = {a.pose.p_WB + Vec3(0.6, 0, 0), core::Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX())};
    scene.joints.push_back(joint);
  }
  return scene;
}

double block_of(int seed) {
  constexpr std::array kSides_m = {4.0, 7.0, 10.0, 16.0, 23.0, 64.0};
  return kSides_m[std::mt19937_64(static_cast<std::uint64_t>(seed))() % kSides_m.size()];
}

int seeds_or(int usual) {
  const char* wanted = std::getenv("AURASIM_SEEDS");
  return wanted ? std::max(1, std::atoi(wanted)) : usual;
}

}  // namespace aurasim::test
