// Groups of bodies placed together: stacks, rows, thrown bodies, and mechanisms with joints.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/scenes/random_kinds.h"

namespace aurasim::lab {

struct Piece {
  std::size_t kind = 0;  ///< index in Kinds::all
  core::Vec3 p = core::Vec3::Zero();
  core::Vec3 v = core::Vec3::Zero();
  core::Vec3 spin = core::Vec3::Zero();
  core::Vec3 rpy_deg = core::Vec3::Zero();
};

/// A joint of the scene file without its place and its bodies.
struct Link {
  Json joint;
  std::vector<std::size_t> pieces;  ///< one (to the world) or two
  core::Vec3 p = core::Vec3::Zero();
  std::optional<std::size_t> leader = {};  ///< the link that a hinge or slider follows
};

/// Bodies and joints around the origin, standing on z = 0.
struct Formation {
  std::vector<Piece> pieces;
  std::vector<Link> links;
};

/// Parameters that formations are made from.
struct Makings {
  const Kinds& kinds;
  double speed_m_s = 10;  ///< highest speed that bodies start with
  double region_m = 10;   ///< width of the narrowest region

  std::size_t any_kind(Chance& chance) const { return chance.below(static_cast<std::uint32_t>(kinds.all.size())); }
  const Kind& kind(const Piece& piece) const { return kinds.all[piece.kind]; }
  double half_height_m(std::size_t kind) const { return kinds.all[kind].half_height_m; }
  double radius_m(std::size_t kind) const { return kinds.all[kind].radius_m; }
};

/// A random formation without joints.
Formation random_heap(const Makings& makings, Chance& chance);
/// A random formation with joints.
Formation random_mechanism(const Makings& makings, Chance& chance);
/// A single body with a velocity.
Formation thrown_body(const Makings& makings, Chance& chance);

/// The formation turned about z by `quarters` quarter turns.
Formation turned(Formation formation, std::uint32_t quarters);

}  // namespace aurasim::lab
