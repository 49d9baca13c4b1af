// A SpeedScene as a text that the driver of every engine reads (tests/bench/peers). One item a line, words and numbers
// apart by blanks; metres, seconds, kilograms, radians; quaternions are w x y z. Items are numbered from 0 in the order
// in which they stand, each kind for itself:
//
//   name NAME, step_hz HZ, steps N, states_every N, fallen_m M, sleeping 0|1, gravity X Y Z
//   shape sphere RADIUS | box HX HY HZ (halves) | capsule RADIUS HEIGHT (between the caps' centres, along z) |
//         plane NX NY NZ OFFSET | hull N X Y Z ...
//   material FRICTION RESTITUTION (of a pair: the product of its two)
//   kind SHAPE MATERIAL MASS
//   static SHAPE MATERIAL P(3) Q(4)
//   body BIRTH KIND P(3) Q(4) V(3) W(3) (BIRTH: the first state in which it is there; ascending)
//   joint ball A B P(3)
//   joint hinge A B P(3) Q(4) LOW HIGH (about z of the joint's frame; of A relative to B; joined bodies do not collide)
#pragma once

#include <filesystem>

#include "lab/speed/speed_scene.h"

namespace aurasim::lab {

/// The scene as text. Throws std::invalid_argument for a scene with something that the format cannot express.
std::string scene_text(const SpeedScene& scene);
void write_scene_text(const SpeedScene& scene, const std::filesystem::path& file);

/// DIR/scenes/NAME.txt.
std::filesystem::path scene_file(const std::filesystem::path& directory, const std::string& name);
/// The scene of this name, as large as the one in DIR/scenes. Throws std::runtime_error if the file is of another
/// version of the program.
SpeedScene scene_written_in(const std::filesystem::path& directory, const std::string& name);

}  // namespace aurasim::lab
