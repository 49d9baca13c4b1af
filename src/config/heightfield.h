// Ground given as a grid of heights.
#pragma once

#include <optional>

#include "config/fields.h"
#include "core/scene.h"

namespace aurasim::config {

/// {cell: [dx, dy], heights: [[...], ...]} as triangles: rows from -y to +y, the grid centred on the origin.
std::optional<core::Shape> read_heightfield(Fields& fields);

}  // namespace aurasim::config
