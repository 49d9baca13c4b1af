// Packs a rotation into 64 bits: the three smaller components of its unit quaternion (w x y z), and the index of the
// one left out. The one left out is the largest and is made positive, so it follows from the others: sqrt(1 - the sum
// of their squares).
#pragma once

#include <cstdint>
#include <optional>

#include "core/body_state.h"

namespace aurasim::messages {

/// Packs `q`, which may have any length but 0, with an error within core::kRotationError_rad. Bits 60 and 61: index of
/// the component left out. Bits 0 to 19, 20 to 39 and 40 to 59: the others in their order, as signed multiples of 1 /
/// (sqrt(2) (2^19 - 1)).
std::uint64_t packed(const core::Quat& q);

/// Unpacks a rotation. Nothing: the bits are no rotation.
std::optional<core::Quat> unpacked_rotation(std::uint64_t bits);

}  // namespace aurasim::messages
