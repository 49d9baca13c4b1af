// The shape that a client's mesh has become, as JSON with all bits of its numbers. Shapes of the scene file are not
// saved.
#pragma once

#include <string>
#include <string_view>

#include "core/world_cut.h"

namespace aurasim::cut {

std::string encode_shape(const core::SavedShape& shape);
/// Reads the JSON of encode_shape(). Throws BadCut.
core::SavedShape decode_shape(std::string_view text);

}  // namespace aurasim::cut
