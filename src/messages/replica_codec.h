// Encodes core/replica.h as a wire type, and decodes it. Same contract as codec.h.
#pragma once

#include "core/replica.h"
#include "messages/codec.h"

namespace aurasim::wire {
class Replica;
}  // namespace aurasim::wire

namespace aurasim::messages {

void encode(const core::Replica& replica, wire::Replica& out);
Decoded<core::Replica> decode(const wire::Replica& in, const Expected& expected);

}  // namespace aurasim::messages
