// The tables of keys of shapes, kind by kind.
#pragma once

#include "config/keys.h"

namespace aurasim::config {

const KeyTable& part_keys();
const KeyTable& capsule_keys();
const KeyTable& hull_of_points_keys();
const KeyTable& hull_of_mesh_keys();

}  // namespace aurasim::config
