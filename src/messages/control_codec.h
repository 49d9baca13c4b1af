// Encodes control_messages.h as wire types, and decodes them. Same contract as codec.h.
#pragma once

#include <variant>

#include "messages/codec.h"
#include "messages/control_messages.h"

namespace aurasim::wire {
class NodeStatus;
class RegionMap;
class RunControl;
}  // namespace aurasim::wire

namespace aurasim::messages {

void encode(const Status& status, wire::NodeStatus& out);
void encode(const WorldMap& map, wire::RegionMap& out);
void encode(const RunCommand& command, std::uint64_t sender, wire::RunControl& out);

Decoded<Status> decode(const wire::NodeStatus& in, const Expected& expected);
Decoded<WorldMap> decode(const wire::RegionMap& in, const Expected& expected);
Decoded<RunCommand> decode(const wire::RunControl& in, const Expected& expected);

}  // namespace aurasim::messages
