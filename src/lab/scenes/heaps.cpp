// Formations without joints.
#include <algorithm>
#include <array>

#include "lab/scenes/formations.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

constexpr double kGap_m = 0.002;  ///< bodies are beside each other, not in each other

Vec3 random_turn_deg(Chance& chance) {
  return {rounded(chance.between(-180, 180)), rounded(chance.between(-90, 90)), rounded(chance.between(-180, 180))};
}

Formation stack(const Makings& makings, Chance& chance) {
  Formation formation;
  double z = 0;
  const std::size_t kind = makings.any_kind(chance);
  for (std::uint32_t left = 3 + chance.below(5); left > 0; --left) {
    const std::size_t next = chance.below(4) == 0 ? makings.any_kind(chance) : kind;
    const double half = makings.half_height_m(next);
    Piece& piece = formation.pieces.emplace_back();
    piece.kind = next;
    piece.p = {chance.between(-0.1, 0.1) * half, chance.between(-0.1, 0.1) * half, z + half + kGap_m};
    z = piece.p.z() + half;
  }
  return formation;
}

/// Along x; the first one falls towards the others.
Formation dominoes(const Makings& makings, Chance& chance) {
  Formation formation;
  const std::uint32_t count = 5 + chance.below(8);
  const double half = makings.half_height_m(Kinds::kDomino);
  for (std::uint32_t i = 0; i < count; ++i) {
    Piece& piece = formation.pieces.emplace_back();
    piece.kind = Kinds::kDomino;
    piece.p = {(i - 0.5 * (count - 1)) * half, 0, half + kGap_m};
  }
  formation.pieces.front().v.x() = chance.between(0, 0.2 * makings.speed_m_s);
  formation.pieces.front().spin.y() = chance.between(0, 3);
  return formation;
}

Formation row(const Makings& makings, Chance& chance) {
  Formation formation;
  const std::size_t kind = makings.any_kind(chance);
  const double apart = chance.between(2.01, 2.6) * makings.radius_m(kind);
  const std::uint32_t count = 3 + chance.below(6);
  for (std::uint32_t i = 0; i < count; ++i) {
    Piece& piece = formation.pieces.emplace_back();
    piece.kind = kind;
    piece.p = {(i - 0.5 * (count - 1)) * apart, 0, makings.half_height_m(kind) + kGap_m};
  }
  if (chance.below(2) == 0) formation.pieces.back().v.x() = -chance.between(0, 0.8 * makings.speed_m_s);
  return formation;
}

/// Mixed bodies that fall onto each other.
Formation pile(const Makings& makings, Chance& chance) {
  Formation formation;
  const std::array<std::size_t, 2> kinds = {makings.any_kind(chance), makings.any_kind(chance)};
  const double apart = 2.02 * std::max(makings.radius_m(kinds[0]), makings.radius_m(kinds[1]));
  const std::uint32_t layers = 1 + chance.below(3), side = 2 + chance.below(2);
  for (std::uint32_t i = 0; i < layers * side * side; ++i) {
    Piece& piece = formation.pieces.emplace_back();
    piece.kind = kinds[chance.below(2)];
    const double x = (i % side - 0.5 * (side - 1)) * apart;
    piece.p = {x, (i / side % side - 0.5 * (side - 1)) * apart, (i / (side * side) + 0.5) * apart};
    piece.rpy_deg = random_turn_deg(chance);
  }
  return formation;
}

/// Bodies from several sides that are to meet where the formation is.
Formation crossfire(const Makings& makings, Chance& chance) {
  constexpr std::array<std::array<double, 2>, 4> kFrom = {{{1, 0}, {-1, 0.02}, {0.02, 1}, {0, -1}}};
  Formation formation;
  const std::uint32_t count = 2 + chance.below(3);
  const double after_s = chance.between(0.1, 0.8);
  for (std::uint32_t i = 0; i < count; ++i) {
    Piece& piece = formation.pieces.emplace_back();
    piece.kind = makings.any_kind(chance);
    const double speed = chance.between(0.2, 0.9) * makings.speed_m_s;
    const Vec3 from(kFrom[i][0], kFrom[i][1], 0);
    const double way = std::min(speed * after_s, 2 * makings.region_m) + 2 * makings.radius_m(piece.kind);
    piece.p = way * from + Vec3(0, 0, makings.radius_m(piece.kind) + chance.between(0.05, 1));
    piece.v = -speed * from;
    piece.spin.z() = chance.between(-20, 20);
  }
  return formation;
}

Formation spinning_bar(const Makings& makings, Chance& chance) {
  Formation formation;
  Piece& piece = formation.pieces.emplace_back();
  piece.kind = Kinds::kBar;
  piece.p.z() = makings.half_height_m(Kinds::kBar) + chance.between(0.01, 1);
  piece.spin.z() = chance.between(10, 40) * (chance.below(2) == 0 ? 1 : -1);
  piece.v.x() = chance.between(-0.3, 0.3) * makings.speed_m_s;
  return formation;
}

}  // namespace

Formation random_heap(const Makings& makings, Chance& chance) {
  using Make = Formation (*)(const Makings&, Chance&);
  constexpr std::array<Make, 7> kMakers = {stack, dominoes, row, pile, pile, crossfire, spinning_bar};
  return kMakers[chance.below(kMakers.size())](makings, chance);
}

Formation thrown_body(const Makings& makings, Chance& chance) {
  Formation formation;
  Piece& piece = formation.pieces.emplace_back();
  piece.kind = makings.any_kind(chance);
  piece.p.z() = makings.radius_m(piece.kind) + chance.between(0.05, 2);
  const double speed = chance.between(0, 0.9) * makings.speed_m_s;
  const Vec3 heading = {chance.between(-0.7, 0.7), chance.between(-0.7, 0.7), chance.between(-0.1, 0.1)};
  piece.v = speed * heading;
  piece.spin = {chance.between(-8, 8), chance.between(-8, 8), chance.between(-8, 8)};
  piece.rpy_deg = random_turn_deg(chance);
  return formation;
}

}  // namespace aurasim::lab
