// Makes the command of an ask, for clients that read meshes from files of their own host.
#pragma once

#include "steering/ask.h"
#include "steering/command_client.h"

namespace aurasim::steering {

/// The command that `ask` is. Looks the static up in `scene`, and sends the mesh of `ask.mesh_file` (OBJ, STL or glTF),
/// or its convex parts, to the nodes. Throws BadAsk. Precondition: the ask is a core::Ask.
core::Command command_of(Ask ask, const core::Scene& scene, CommandClient& client);

}  // namespace aurasim::steering
