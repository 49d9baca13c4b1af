// Encodes core/interest.h as a wire type, and decodes it. Same contract as codec.h.
#pragma once

#include "core/interest.h"
#include "messages/codec.h"

namespace aurasim::wire {
class Interest;
}  // namespace aurasim::wire

namespace aurasim::messages {

void encode(const core::Interest& interest, std::uint64_t map_version, wire::Interest& out);
Decoded<core::Interest> decode(const wire::Interest& in, const Expected& expected);

}  // namespace aurasim::messages
