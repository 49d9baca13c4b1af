// Bodies that belong together, around a place of their own: stacks, rows, thrown bodies, and what joints hold together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/scenes/random_kinds.h"

namespace aurasim::lab {

struct Piece {
  std::size_t kind = 0;  ///< of Kinds::all
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

/// Around the origin, standing on z = 0.
struct Formation {
  std::vector<Piece> pieces;
  std::vector<Link> links;
};

/// What formations are made from.
struct Makings {
  const Kinds& kinds;
  double speed_m_s = 10;  ///< that bodies may start with
  double region_m = 10;   ///< how wide the narrowest region is

  std::size_t any_kind(Chance& chance) const { return chance.below(static_cast<std::uint32_t>(kinds.all.size())); }
  const Kind& kind(const Piece& piece) const { return kinds.all[piece.kind]; }
  double half_height_m(std::size_t kind) const { return kinds.all[kind].half_height_m; }
  double radius_m(std::size_t kind) const { return kinds.all[kind].radius_m; }
};

/// One of those without joints.
Formation random_heap(const Makings& makings, Chance& chance);
/// One of those with joints.
Formation random_mechanism(const Makings& makings, Chance& chance);
/// One body on its way.
Formation thrown_body(const Makings& makings, Chance& chance);

/// Turned about z by so many quarter turns.
Formation turned(Formation formation, std::uint32_t quarters);

}  // namespace aurasim::lab
