// Meshes that a client brings from files of its own host.
#pragma once

#include <stdexcept>
#include <string>

#include "cli/command_client.h"

namespace aurasim::cli {

/// A mesh file that cannot be used; begins with its name.
class BadMesh : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Gives the mesh in `file` (OBJ, STL or glTF), or its convex parts, to the nodes. Throws BadMesh.
core::MeshRef bring_mesh(const std::string& file, core::MeshUse use, CommandClient& client);

}  // namespace aurasim::cli
