// Ground given as a grid of heights.
#pragma once

#include <optional>

#include "config/fields.h"
#include "core/scene.h"

namespace aurasim::config {

const KeyTable& heightfield_keys();

/// Reads a heightfield and returns it as triangles.
std::optional<core::Shape> read_heightfield(const Fields& fields);

}  // namespace aurasim::config
