// One table of limits: what is asked for within it can be done, what is beyond it is refused with a reason.
#include "steering/command_limits.h"

#include <limits>

#include <gtest/gtest.h>

#include "core/limits.h"

namespace aurasim::steering {
namespace {

using core::BodyId;
using core::Vec3;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class CommandLimits : public ::testing::Test {
 protected:
  CommandLimits() {
    launch_.scene.shapes = {{"ball", core::Sphere{0.5}}};
    launch_.scene.prototypes = {{"ball", 0, 0, 1, true}};
    launch_.tolerances.speed_m_s = 30;
    launch_.time.substeps = 4;
  }
  std::string problem(const core::Ask& ask, core::Step at_step = 0) const {
    std::optional<core::Shape> shape;
    if (const auto* body = std::get_if<core::NewBody>(&ask); body && body->shape) {
      shape = std::visit(
          [](const auto& s) -> core::Shape {
            if constexpr (std::is_constructible_v<core::Shape, decltype(s)>) return s;
            return core::Sphere{};
          },
          *body->shape);
    }
    return problem_with({1, at_step, ask}, {launch_, launch_.scene, 100, bodies_, shape});
  }
  void expect_refusal(const core::Ask& ask, const std::string& because) const {
    EXPECT_NE(problem(ask).find(because), std::string::npos) << "'" << problem(ask) << "' says nothing of " << because;
  }
  static core::NewBody box(double x, double y, double z, double mass_kg = 1) {
    core::NewBody body;
    body.shape = core::Box{{x / 2, y / 2, z / 2}};
    body.mass_kg = mass_kg;
    return body;
  }

  config::Launch launch_;
  std::uint64_t bodies_ = 1;
};

TEST_F(CommandLimits, AStaticIsSentWhereItCanGo) {
  launch_.scene.shapes.push_back({"ground", core::Plane{}});
  core::StaticBody plane;
  plane.shape = 1;
  launch_.scene.statics = {{}, plane};
  const core::Pose there{{1, 2, 3}, core::Quat::Identity()};
  EXPECT_EQ(problem(core::SendStatic{core::StaticId{0}, there, 2}), "");
  expect_refusal(core::SendStatic{core::StaticId{1}, there, 2}, "a plane cannot move");
  expect_refusal(core::SendStatic{core::StaticId{2}, there, 2}, "there is no static 2");
  expect_refusal(core::SendStatic{core::StaticId{0}, {{1e9, 0, 0}, core::Quat::Identity()}, 2}, "move.p: found [1e+09");
  expect_refusal(core::SendStatic{core::StaticId{0}, there, -1}, "allowed: 0 to");
  launch_.physics.solver = "sequential_impulse";
  expect_refusal(core::SendStatic{core::StaticId{0}, there, 2}, "sequential_impulse cannot move statics");
}

TEST_F(CommandLimits, ASpinIsAtMostAQuarterTurnInASubstep) {
  EXPECT_EQ(problem(core::SetVelocity{BodyId{1}, Vec3::Zero(), Vec3(376, 0, 0)}), "");
  expect_refusal(core::SetVelocity{BodyId{1}, Vec3::Zero(), Vec3(378, 0, 0)}, "allowed: 377 rad/s");
  expect_refusal(core::SetVelocity{BodyId{1}, Vec3::Zero(), Vec3(1e6, 1e6, 1e6)}, "quarter turn");
  core::NewBody body = box(1, 1, 1);
  body.w_WB = {0, 0, 1e6};
  expect_refusal(body, "quarter turn");
}

TEST_F(CommandLimits, ARateCanBeUndone) {
  EXPECT_EQ(problem(core::SetRate{0.01}), "");
  EXPECT_EQ(problem(core::SetRate{10}), "");
  for (const double rate : {0.0, 1e-6, 1e-300, 10.1, -1.0, kNan, kInfinity}) {
    expect_refusal(core::SetRate{rate}, "allowed: 0.01 to 10");
  }
}

TEST_F(CommandLimits, SizesAndMassesAreThoseOfThings) {
  EXPECT_EQ(problem(box(1, 1, 0.002)), "");
  expect_refusal(box(1, 1, 1e-300), "spawn.shape.size");
  expect_refusal(box(0.01, 0.01, 0.01), "radius");
  expect_refusal(box(1e6, 1, 1), "spawn.shape.size");
  expect_refusal(box(1, 1, kNan), "spawn.shape.size");
  expect_refusal(box(1, 1, 1, 0), "mass");
  expect_refusal(box(1, 1, 1, 1e7), "mass");
  expect_refusal(box(1, 1, 1, kNan), "mass");
}

TEST_F(CommandLimits, PlacesAndRotationsAreSound) {
  core::NewBody body = box(1, 1, 1);
  body.pose.p_WB = {0, 0, 1.1e6};
  expect_refusal(body, "spawn.p: found [0, 0, 1.1e+06]");
  body.pose.p_WB = {0, kNan, 0};
  expect_refusal(body, "spawn.p: found [0, nan, 0]");
  body.pose.p_WB = Vec3::Zero();
  body.pose.q_WB = core::Quat(0, 0, 0, 0);
  expect_refusal(body, "quaternion");
}

TEST_F(CommandLimits, SpeedsAreThoseThatTheRunPromises) {
  EXPECT_EQ(problem(core::SetVelocity{BodyId{1}, {0, 30, 0}, {}}), "");
  expect_refusal(core::SetVelocity{BodyId{1}, {0, 31, 0}, {}}, "tolerances.speed");
  expect_refusal(core::SetVelocity{BodyId{1}, {kNan, 0, 0}, {}}, "tolerances.speed");
}

TEST_F(CommandLimits, ImpulsesAreFinite) {
  EXPECT_EQ(problem(core::Impulse{BodyId{1}, {0, 0, 1e6}, {}}), "");
  expect_refusal(core::Impulse{BodyId{1}, {0, 0, 1e8}, {}}, "allowed: 1e+07 N s");
  expect_refusal(core::Impulse{BodyId{1}, {kInfinity, 0, 0}, {}}, "allowed: 1e+07 N s");
  expect_refusal(core::Impulse{BodyId{1}, {1, 0, 0}, Vec3(0, 0, 1e9)}, "impulse.p: found");
}

TEST_F(CommandLimits, RaysBeginAndEndInTheWorld) {
  EXPECT_EQ(problem(core::Ray{{0, 0, 1e5}, {0, 0, -1e5}, {}}), "");
  expect_refusal(core::Ray{{0, 0, 1e300}, {0, 0, 0}, {}}, "ray.from: found");
  expect_refusal(core::Ray{{0, 0, 0}, {0, kNan, 0}, {}}, "ray.to: found");
}

/// A change of the run closes it to other commands until it is made.
TEST_F(CommandLimits, AnOrderIsNotForAYearAhead) {
  EXPECT_EQ(problem(core::RemoveBody{BodyId{1}}, 1000), "");
  EXPECT_NE(problem(core::RemoveBody{BodyId{1}}, 9'000'000'000), "");
}

TEST_F(CommandLimits, AWorldCanBeFull) {
  bodies_ = core::limits::kMostBodies;
  expect_refusal(box(1, 1, 1), "allowed: 100000");
}

}  // namespace
}  // namespace aurasim::steering
