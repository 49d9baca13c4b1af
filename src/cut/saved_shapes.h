// A shape that a client's mesh has become, as JSON with every bit of its numbers: what a scene file says of its own
// need not be saved.
#pragma once

#include <string>
#include <string_view>

#include "core/world_cut.h"

namespace aurasim::cut {

std::string encode_shape(const core::SavedShape& shape);
/// Throws BadCut.
core::SavedShape decode_shape(std::string_view text);

}  // namespace aurasim::cut
