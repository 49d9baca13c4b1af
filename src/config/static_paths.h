// Where statics go.
#pragma once

#include "config/fields.h"
#include "core/scene.h"

namespace aurasim::config {

const KeyTable& path_keys();

/// `path:` of a static that stands as it is read.
std::optional<core::StaticPath> read_path(const Field& field);

}  // namespace aurasim::config
