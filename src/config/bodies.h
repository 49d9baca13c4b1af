// Materials, prototypes, statics and bodies of a scene.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

/// {NAME: {friction, rolling_friction, spinning_friction, restitution, linear_damping, angular_damping}, ...}
void read_materials(const Field& field, SceneDraft& draft);

/// {NAME: {SHAPE}, ...}
void read_shapes(const Field& field, SceneDraft& draft);

/// {NAME: {shape, mass, material, can_sleep}, ...}
void read_prototypes(const Field& field, SceneDraft& draft);

/// [{name, shape, material, position, orientation}, ...]
void read_statics(const Field& field, SceneDraft& draft);

/// [{name, id, prototype, position, orientation, velocity, spin}, ...]
void read_bodies(const Field& field, SceneDraft& draft);

/// Gives the bodies without an id the lowest free ones, in their order, and puts all in order of id.
void number_bodies(SceneDraft& draft);

/// Metres per second, and radians per second, of one component.
inline constexpr Range kSpeed = Range::from_to(-1e4, 1e4);

}  // namespace aurasim::config
