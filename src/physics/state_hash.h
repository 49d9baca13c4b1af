// State hash: shows whether two states of a body are the same to the last bit.
#pragma once

#include <cstdint>
#include <span>

#include "core/body_state.h"

namespace aurasim::physics {

/// 64-bit hash of a body's id and full dynamic state (not its epoch). Equal bits, equal hash.
std::uint64_t state_hash(const core::BodyRecord& body);

/// Writes the hash of each body to `hashes`, which has room for them. Several times faster than one by one.
void state_hashes(std::span<const core::BodyRecord> bodies, std::span<std::uint64_t> hashes);

/// Sum of the hashes of all bodies, modulo 2^64. Several times faster than one by one.
std::uint64_t state_hash_sum(std::span<const core::BodyRecord> bodies);

}  // namespace aurasim::physics
