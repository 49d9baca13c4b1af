// Encodes the messages of core/command.h, and meshes, as wire types, and decodes them. Same contract as codec.h.
#pragma once

#include <cstdint>

#include "core/command.h"
#include "core/scene.h"
#include "messages/codec.h"

namespace aurasim::wire {
class Command;
class CommandReply;
class MeshShape;
}  // namespace aurasim::wire

namespace aurasim::messages {

struct NamedMesh {
  std::uint64_t hash = 0;
  core::TriangleMesh mesh;
  /// A node publishes the mesh again for late joiners: no command that needs it is under way.
  bool is_told_again = false;
};

void encode(const core::Command& command, std::uint64_t sender, std::uint64_t map_version, wire::Command& out);
void encode(const core::CommandReply& reply, std::uint64_t map_version, wire::CommandReply& out);
void encode(const NamedMesh& mesh, wire::MeshShape& out);

Decoded<core::Command> decode(const wire::Command& in, const Expected& expected);
Decoded<core::CommandReply> decode(const wire::CommandReply& in, const Expected& expected);
Decoded<NamedMesh> decode(const wire::MeshShape& in, const Expected& expected);

}  // namespace aurasim::messages
