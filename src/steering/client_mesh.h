// Meshes that a client sends from files of its own host.
#pragma once

#include <stdexcept>
#include <string>

#include "steering/command_client.h"

namespace aurasim::steering {

/// Thrown for a mesh file that cannot be used. The message begins with the file's name.
class BadMesh : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Sends the mesh in `file` (OBJ, STL or glTF), or its convex parts, to the nodes, depending on `use`. Throws BadMesh.
core::MeshRef bring_mesh(const std::string& file, core::MeshUse use, CommandClient& client);

}  // namespace aurasim::steering
