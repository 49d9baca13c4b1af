// Reads the paths of moving statics.
#pragma once

#include "config/fields.h"
#include "core/scene.h"

namespace aurasim::config {

const KeyTable& path_keys();

/// Reads `path:` of a static. The stops are poses in the frame of the static at its start (StaticPath).
std::optional<core::StaticPath> read_path(const Field& field);

}  // namespace aurasim::config
