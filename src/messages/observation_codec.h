// Encodes core/observation.h as a wire type, and decodes it. Same contract as codec.h.
#pragma once

#include "core/observation.h"
#include "messages/codec.h"

namespace aurasim::wire {
class Observation;
}  // namespace aurasim::wire

namespace aurasim::messages {

void encode(const core::Observation& observation, wire::Observation& out);
Decoded<core::Observation> decode(const wire::Observation& in, const Expected& expected);

}  // namespace aurasim::messages
