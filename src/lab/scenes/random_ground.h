// What the bodies of a random world stand on.
#pragma once

#include <map>
#include <string>

#include "lab/pair.h"
#include "lab/scenes/json.h"
#include "lab/scenes/random_layout.h"

namespace aurasim::lab {

/// Mesh files that a scene names: their text by their names.
using MeshTexts = std::map<std::string, std::string>;

/// "statics" of the scene: a plane, boxes, a heightfield or a mesh, none above z = 0, and at times walls around it all.
void add_ground(const RandomLayout& layout, Json& scene, MeshTexts& meshes, Chance& chance);

/// Lifts, gates, turnstiles and belts where regions meet, in "statics". For worlds that soft_step solves.
void add_moving_statics(const RandomLayout& layout, Json& scene, Chance& chance);

}  // namespace aurasim::lab
