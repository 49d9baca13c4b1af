// A rotation in 64 bits: the three smaller components of its unit quaternion (w x y z), and which one is left out. That
// one is the largest and made positive, so the others say it: sqrt(1 - the sum of their squares).
#pragma once

#include <cstdint>
#include <optional>

#include "core/body_state.h"

namespace aurasim::dds {

/// Bits 60 and 61: index of the component left out. Bits 0 to 19, 20 to 39 and 40 to 59: the others in their order, as
/// signed multiples of 1 / (sqrt(2) (2^19 - 1)). Within core::kRotationError_rad of `q`, which may have any length
/// but 0.
std::uint64_t packed(const core::Quat& q);

/// Nothing for bits that no rotation has.
std::optional<core::Quat> unpacked_rotation(std::uint64_t bits);

}  // namespace aurasim::dds
