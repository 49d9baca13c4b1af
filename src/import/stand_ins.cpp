#include "import/stand_ins.h"

#include "import/inertia.h"
#include "physics/inertia.h"

namespace aurasim::importing {
namespace {

using core::Vec3;

constexpr double kSmallBall_m = 0.01;

core::ConvexShape convex_of(const Geometry& geometry) {
  return std::visit(
      [](const auto& shape) -> core::ConvexShape {
        if constexpr (std::is_constructible_v<core::ConvexShape, decltype(shape)>) {
          return shape;
        } else {
          throw std::logic_error("a moving link has a shape that is not convex");
        }
      },
      geometry);
}

bool is_identity(const core::Pose& pose) { return pose.p_WB.isZero(0) && pose.q_WB.vec().isZero(0); }

}  // namespace

core::Shape body_shape(const Link& link) {
  if (link.collisions.empty()) return core::Sphere{kSmallBall_m};
  const core::Pose X_BL = inverse({link.p_LB, core::Quat(principal_inertia(link.I_BL).R_LB)});
  core::Compound compound;
  for (const Collision& collision : link.collisions) {
    compound.parts.push_back({convex_of(collision.geometry), X_BL * collision.X_LC});
  }
  if (compound.parts.size() > 1 || !is_identity(compound.parts.front().pose)) return compound;
  return std::visit([](const auto& shape) { return core::Shape(shape); }, compound.parts.front().shape);
}

void spread_mass_evenly(double mass_kg, const Vec3& p_LB, Link& link) {
  link.mass_kg = mass_kg;
  link.p_LB = p_LB;
  link.I_BL = core::Mat3::Zero();
  link.I_BL = core::Mat3(physics::inertia_diagonal(body_shape(link), mass_kg).asDiagonal());
}

}  // namespace aurasim::importing
