// Bodies that touch nothing.
#include <cmath>

#include "lab/stability/scene_builder.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

Metric off_parabola(const Vec3& p0, const Vec3& v0) {
  return {"distance from the parabola", "m", Over::kLargest, [=](const Moment& now) {
            const Vec3 expected = p0 + now.t_s * v0 + 0.5 * now.t_s * now.t_s * Vec3(0, 0, -kGravity);
            return (now.bodies[0].p_WB - expected).norm();
          }};
}

Case thrown(const std::string& name, const Vec3& p0, const Vec3& v0) {
  Case c{name, "p0 + v0 t - g t^2 / 2", 0, 2};
  SceneBuilder scene(name);
  scene.body(core::Sphere{0.5}, 1, p0, v0);
  c.scene = scene.scene();
  c.metrics = {off_parabola(p0, v0)};
  return c;
}

/// A weight that swings along x across the border. The spring is slack in state 0.
Case spring() {
  constexpr double kStiffness = 40, kAmplitude = 0.5;
  const double frequency = std::sqrt(kStiffness);
  Case c{"spring", "x0 sin(sqrt(k/m) t); k = 40 N/m, m = 1 kg, x0 = 0.5 m", 0, 10};
  SceneBuilder scene(c.name, Vec3::Zero());
  const core::BodyId weight = scene.body(core::Sphere{0.2}, 1, {0, 0, 5}, {frequency * kAmplitude, 0, 0});
  core::SpringJoint joint;
  joint.axes[0].stiffness = kStiffness;
  scene.joint(joint, weight, std::nullopt, {Vec3(0, 0, 5), core::Quat::Identity()});
  c.scene = scene.scene();
  c.metrics = {{"distance from the sine", "m", Over::kLargest,
                [=](const Moment& now) {
                  return std::abs(now.bodies[0].p_WB.x() - kAmplitude * std::sin(frequency * now.t_s));
                }},
               {"|E - E0| / E0", "1", Over::kLargest, [=](const Moment& now) {
                  const double x = now.bodies[0].p_WB.x();
                  const double whole = 0.5 * kStiffness * kAmplitude * kAmplitude;
                  return std::abs(0.5 * now.bodies[0].v_WB.squaredNorm() + 0.5 * kStiffness * x * x - whole) / whole;
                }}};
  return c;
}

Vec3 momentum(const core::BodyRecord& body, const Vec3& inertia) {
  return body.R_WB * inertia.cwiseProduct(body.R_WB.transpose() * body.w_WB);
}

/// A spinning box of 0.1 x 0.4 x 0.9 m, 10 kg, that drifts over the border.
Case dzhanibekov() {
  const Vec3 inertia(0.97 / 1.2, 0.82 / 1.2, 0.17 / 1.2);
  const Vec3 w0(0.1, 5, 0.1);
  Case c{"dzhanibekov",
         "Euler's equations: L and E stay. I = diag(.80833, .68333, .14167) kg m^2, w0 = (.1, 5, .1) rad/s", 0, 10};
  SceneBuilder scene(c.name, Vec3::Zero());
  scene.body(core::Box{{0.05, 0.2, 0.45}}, 10, {-0.5, 0, 5}, {0.1, 0, 0}, w0);
  c.scene = scene.scene();
  const Vec3 L0 = inertia.cwiseProduct(w0);
  const double E0 = 0.5 * w0.dot(L0);
  c.metrics = {{"|L - L0| / |L0|", "1", Over::kLargest,
                [=](const Moment& now) { return (momentum(now.bodies[0], inertia) - L0).norm() / L0.norm(); }},
               {"|E - E0| / E0, of rotation", "1", Over::kLargest, [=](const Moment& now) {
                  const core::BodyRecord& body = now.bodies[0];
                  return std::abs(0.5 * body.w_WB.dot(momentum(body, inertia)) - E0) / E0;
                }}};
  return c;
}

Case spinning_disc() {
  const core::Cylinder disc{0.5, 0.2};
  const double across = 0.25 / 4 + 0.04 / 12;
  const Vec3 inertia(across, across, 0.125);
  const Vec3 w0(1, 0, 10);
  const Vec3 L = inertia.cwiseProduct(w0);
  Case c{"spinning_disc", "the axis goes round L at |L| / I1 (free symmetric top); 1 kg, w0 = (1, 0, 10) rad/s", 0, 10};
  SceneBuilder scene(c.name, Vec3::Zero());
  scene.body(disc, 1, {-0.5, 0, 5}, {0.1, 0, 0}, w0);
  c.scene = scene.scene();
  c.metrics = {{"angle of the axis from where it should be", "rad", Over::kLargest, [=](const Moment& now) {
                  const Eigen::AngleAxisd precession(L.norm() / inertia.x() * now.t_s, L.normalized());
                  const Vec3 expected = precession * Vec3::UnitZ();
                  const Vec3 axis = now.bodies[0].R_WB.col(2);
                  return std::atan2(axis.cross(expected).norm(), axis.dot(expected));
                }}};
  return c;
}

}  // namespace

std::vector<Case> flight_cases() {
  return {thrown("free_fall", {-0.1, 0, 50}, Vec3::Zero()), thrown("projectile", {-10, 0, 1}, {10, 3, 12}), spring(),
          dzhanibekov(), spinning_disc()};
}

}  // namespace aurasim::lab
