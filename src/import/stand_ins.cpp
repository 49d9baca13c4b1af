#include "import/stand_ins.h"

#include <fmt/format.h>

#include "import/inertia.h"
#include "physics/inertia.h"

namespace aurasim::importing {
namespace {

using core::Vec3;

constexpr double kSameMoments = 1e-6;  ///< relative: files give six digits or so

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

void stand_in_for(std::size_t i, Model& model) {
  Link& link = model.links[i];
  const PrincipalInertia inertia = principal_inertia(link.I_BL);
  model.lose(element_name("link", link.name),
             "it has no collision shape: the box of its mass and moments stands for it, and may touch other models");
  link.collisions.push_back({.name = "stand-in",
                             .geometry = equal_box(link.mass_kg, inertia.moments),
                             .X_LC = {link.p_LB, core::Quat(inertia.R_LB)},
                             .surface = {}});
  for (std::size_t other = 0; other < model.links.size(); ++other) {
    if (other != i && !model.links[other].is_static) model.apart.emplace_back(i, other);
  }
}

}  // namespace

core::Shape body_shape(const Link& link) {
  const core::Pose X_BL = inverse({link.p_LB, core::Quat(principal_inertia(link.I_BL).R_LB)});
  core::Compound compound;
  for (const Collision& collision : link.collisions) {
    compound.parts.push_back({convex_of(collision.geometry), X_BL * collision.X_LC});
  }
  if (compound.parts.size() > 1 || !is_identity(compound.parts.front().pose)) return compound;
  return std::visit([](const auto& shape) { return core::Shape(shape); }, compound.parts.front().shape);
}

void give_stand_ins(Model& model) {
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (!model.links[i].is_static && model.links[i].collisions.empty()) stand_in_for(i, model);
  }
}

void give_one_surface(Model& model) {
  for (Link& link : model.links) {
    if (link.is_static || link.collisions.empty()) continue;
    const Surface first = link.collisions.front().surface;
    bool same = true;
    for (Collision& collision : link.collisions) {
      same = same && collision.surface == first;
      collision.surface = first;
    }
    if (!same) {
      model.lose(element_name("link", link.name),
                 fmt::format("its shapes have surfaces of their own: that of '{}' stands for all",
                             link.collisions.front().name));
    }
  }
}

void compare_inertias(Model& model) {
  for (const Link& link : model.links) {
    if (link.is_static) continue;
    const Vec3 given = principal_inertia(link.I_BL).moments;
    const Vec3 spread = physics::inertia_diagonal(body_shape(link), link.mass_kg);
    if ((spread - given).cwiseAbs().maxCoeff() <= kSameMoments * given.maxCoeff()) continue;
    model.lose(element_name("link", link.name),
               fmt::format("its moments of inertia, {:.6g}, {:.6g} and {:.6g} kg m^2: a scene spreads mass evenly over "
                           "the shape, which makes {:.6g}, {:.6g} and {:.6g}",
                           given.x(), given.y(), given.z(), spread.x(), spread.y(), spread.z()));
  }
}

void spread_mass_evenly(double mass_kg, const Vec3& p_LB, Link& link) {
  link.mass_kg = mass_kg;
  link.p_LB = p_LB;
  link.I_BL = core::Mat3::Zero();
  link.I_BL = core::Mat3(physics::inertia_diagonal(body_shape(link), mass_kg).asDiagonal());
}

}  // namespace aurasim::importing
