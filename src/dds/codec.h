// core/messages.h as wire types (idl/aurasim.idl), and back. Encoding keeps the target's memory. Decoding checks
// everything: whatever the bytes, the result is a message that the rest may use, or the reason why not.
#pragma once

#include <variant>

#include "core/messages.h"
#include "dds/wire_error.h"

namespace aurasim::wire {
class AuraBatch;
class Migration;
class MigrationAck;
}  // namespace aurasim::wire

namespace aurasim::dds {

template <class Message>
using Decoded = std::variant<Message, WireError>;

void encode(const core::AuraBatch& batch, wire::AuraBatch& out);
void encode(const core::HandOff& hand_off, wire::Migration& out);
/// An ack does not know its map in core.
void encode(const core::HandOffAck& ack, std::uint64_t map_version, wire::MigrationAck& out);

Decoded<core::AuraBatch> decode(const wire::AuraBatch& in, const Expected& expected);
Decoded<core::HandOff> decode(const wire::Migration& in, const Expected& expected);
Decoded<core::HandOffAck> decode(const wire::MigrationAck& in, const Expected& expected);

}  // namespace aurasim::dds
