// Shapes that clients' meshes have become, as CBOR: what a scene file says of its own need not be saved.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/world_cut.h"

namespace aurasim::cut {

std::vector<std::uint8_t> encode_shapes(const std::vector<core::SavedShape>& shapes);
/// Throws BadCut.
std::vector<core::SavedShape> decode_shapes(std::string_view bytes);

}  // namespace aurasim::cut
