// Reads materials, prototypes, statics and bodies of a scene.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

const KeyTable& material_keys();
const KeyTable& prototype_keys();
const KeyTable& static_keys();
const KeyTable& body_keys();

/// Each reads the value of its key of a scene: `materials`, `shapes` and so on.
void read_materials(const Field& field, SceneDraft& draft);
void read_shapes(const Field& field, SceneDraft& draft);
void read_prototypes(const Field& field, SceneDraft& draft);
void read_statics(const Field& field, SceneDraft& draft);
void read_bodies(const Field& field, SceneDraft& draft);

/// Gives bodies without an id the lowest free ones, in their order, and sorts all bodies by id.
void number_bodies(SceneDraft& draft);

}  // namespace aurasim::config
