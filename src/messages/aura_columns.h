// Encodes auras as columns of a wire::AuraBatch, in as few bytes as their use allows (docs/protocol.md): 37 bytes per
// aura where only the pose matters, 65 with motion, 1 more where not every aura is for every listener. Positions,
// rotations and velocities are rounded (core/aura_precision.h).
#pragma once

#include <optional>
#include <vector>

#include "core/messages.h"
#include "messages/wire_error.h"

namespace aurasim::wire {
class AuraBatch;
}

namespace aurasim::messages {

/// Writes the updates of `batch` into the columns of `out`, whose header is already there.
void encode_auras(const core::AuraBatch& batch, wire::AuraBatch& out);

/// Returns what is wrong with the columns, or nothing if they can be decoded.
std::optional<WireError> check_auras(const wire::AuraBatch& in, const Expected& expected);

/// Precondition: check_auras has found nothing wrong with the columns.
std::vector<core::AuraRecord> decode_auras(const wire::AuraBatch& in);

}  // namespace aurasim::messages
