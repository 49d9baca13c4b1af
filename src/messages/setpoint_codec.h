// Encodes core/setpoint.h as a wire type, and decodes it. Same contract as codec.h.
#pragma once

#include "core/setpoint.h"
#include "messages/codec.h"

namespace aurasim::wire {
class Setpoints;
}  // namespace aurasim::wire

namespace aurasim::messages {

void encode(const core::Setpoints& setpoints, std::uint64_t map_version, wire::Setpoints& out);
Decoded<core::Setpoints> decode(const wire::Setpoints& in, const Expected& expected);

}  // namespace aurasim::messages
