// State hash: shows whether two states of a body are the same to the last bit.
#pragma once

#include <cstdint>

#include "core/body_state.h"

namespace aurasim::physics {

/// 64-bit hash of a body's id and full dynamic state (not its epoch). Equal bits, equal hash.
std::uint64_t state_hash(const core::BodyRecord& body);

}  // namespace aurasim::physics
