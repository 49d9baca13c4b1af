// Reads and takes apart clients' meshes in a child process with limits for time and memory. If a file crashes the
// libraries that read it, this process goes on.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <variant>

#include "core/scene.h"

namespace aurasim::overseer {

/// A mesh, or the reason why there is none.
using MeshOrWhy = std::variant<core::TriangleMesh, std::string>;

struct MeshProcess {
  std::string program = "/proc/self/exe";  ///< aurasim
  std::chrono::milliseconds limit{10'000};

  /// As config::read_mesh, in a child process. Blocks until it has ended.
  MeshOrWhy read(const std::string& name, std::string_view bytes) const;
  /// As config::decompose, in a child process. Blocks until it has ended.
  MeshOrWhy decompose(const core::TriangleMesh& mesh) const;
};

/// Reads a mesh in a child process of this program.
MeshOrWhy read_mesh_apart(const std::string& name, std::string_view bytes);

/// The bytes that the two processes exchange, in native byte order.
std::string mesh_bytes(const MeshOrWhy& mesh);
/// Decodes and checks such bytes. Returns the reason if they are no mesh.
MeshOrWhy mesh_of_bytes(std::string_view bytes);

}  // namespace aurasim::overseer
