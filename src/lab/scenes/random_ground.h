// Random statics that the bodies of a random world stand on.
#pragma once

#include <map>
#include <string>

#include "lab/pair.h"
#include "lab/scenes/json.h"
#include "lab/scenes/random_layout.h"

namespace aurasim::lab {

/// Texts of the mesh files that a scene names, by file name.
using MeshTexts = std::map<std::string, std::string>;

/// Adds "statics" to the scene: a plane, boxes, a heightfield or a mesh, none above z = 0, and sometimes walls around
/// them.
void add_ground(const RandomLayout& layout, Json& scene, MeshTexts& meshes, Chance& chance);

/// Adds lifts, gates, turnstiles and belts to "statics" where regions meet. Only for worlds with solver soft_step.
void add_moving_statics(const RandomLayout& layout, Json& scene, Chance& chance);

}  // namespace aurasim::lab
