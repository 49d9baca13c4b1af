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
  double radius_m = 0;       ///< radius of a sphere around the origin that contains the shape
  double half_height_m = 0;  ///< half the extent along z, without rotation
  double mass_kg = 1;
};

/// All kinds of a world. The first ones exist in every world, because formations need them.
struct Kinds {
  static constexpr std::size_t kBar = 0;     ///< long along x
  static constexpr std::size_t kDomino = 1;  ///< thin along x
  static constexpr std::size_t kWheel = 2;   ///< a cylinder

  std::vector<Kind> all;

  double largest_radius_m() const;
};

/// Draws kinds with all types of shapes. `half_m`: about half the size of each. `largest_m`: radius of one larger
/// shape; 0: none.
Kinds random_kinds(double half_m, double largest_m, Chance& chance);

/// Adds "materials", "shapes" and "prototypes" to the scene. The material "ground" is for statics.
void add_kinds(const Kinds& kinds, Json& scene, Chance& chance);

}  // namespace aurasim::lab
