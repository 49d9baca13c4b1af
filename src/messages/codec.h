// Encodes core/messages.h as wire types (idl/aurasim.idl), and decodes them. Encoding reuses the target's memory.
// Decoding checks everything: whatever the bytes, it returns either a valid message or the error.
#pragma once

#include <variant>

#include "core/messages.h"
#include "messages/wire_error.h"

namespace aurasim::wire {
class AuraBatch;
class Migration;
}  // namespace aurasim::wire

namespace aurasim::messages {

template <class Message>
using Decoded = std::variant<Message, WireError>;

void encode(const core::AuraBatch& batch, wire::AuraBatch& out);
void encode(const core::HandOff& hand_off, wire::Migration& out);

Decoded<core::AuraBatch> decode(const wire::AuraBatch& in, const Expected& expected);
Decoded<core::HandOff> decode(const wire::Migration& in, const Expected& expected);

}  // namespace aurasim::messages
