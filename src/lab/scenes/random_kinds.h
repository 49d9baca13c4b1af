// Kinds of bodies from a seed: materials, shapes and prototypes of a scene file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lab/pair.h"
#include "lab/scenes/json.h"

namespace aurasim::lab {

/// One prototype, and what is needed to place bodies of it.
struct Kind {
  std::string name;
  Json shape;
  double radius_m = 0;       ///< of a sphere around the origin that holds it
  double half_height_m = 0;  ///< along z, as it is when it is not turned
  double mass_kg = 1;
};

/// The first of `all` are there in every world, for formations that need them.
struct Kinds {
  static constexpr std::size_t kBar = 0;     ///< long along x
  static constexpr std::size_t kDomino = 1;  ///< thin along x
  static constexpr std::size_t kWheel = 2;   ///< a cylinder

  std::vector<Kind> all;

  double largest_radius_m() const;
};

/// Shapes of all kinds, about `half_m` in half their size. `largest_m`: radius of one that is larger; 0: none.
Kinds random_kinds(double half_m, double largest_m, Chance& chance);

/// "materials", "shapes" and "prototypes" of the scene. The material "ground" is for what does not move.
void add_kinds(const Kinds& kinds, Json& scene, Chance& chance);

}  // namespace aurasim::lab
