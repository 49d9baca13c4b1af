// Materials, prototypes, statics and bodies of a scene.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

const KeyTable& material_keys();
const KeyTable& prototype_keys();
const KeyTable& static_keys();
const KeyTable& body_keys();

/// Each takes what stands behind its key of a scene: `materials`, `shapes` and so on.
void read_materials(const Field& field, SceneDraft& draft);
void read_shapes(const Field& field, SceneDraft& draft);
void read_prototypes(const Field& field, SceneDraft& draft);
void read_statics(const Field& field, SceneDraft& draft);
void read_bodies(const Field& field, SceneDraft& draft);

/// Gives the bodies without an id the lowest free ones, in their order, and puts all in order of id.
void number_bodies(SceneDraft& draft);

}  // namespace aurasim::config
