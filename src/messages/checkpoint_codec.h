// Encodes messages/checkpoint.h as a wire type, and decodes it. Same contract as codec.h, except that the content of
// `octets` is checked by cut/.
#pragma once

#include "messages/checkpoint.h"
#include "messages/codec.h"

namespace aurasim::wire {
class Checkpoint;
}  // namespace aurasim::wire

namespace aurasim::messages {

void encode(const Checkpoint& checkpoint, wire::Checkpoint& out);
Decoded<Checkpoint> decode(const wire::Checkpoint& in, const Expected& expected);

}  // namespace aurasim::messages
