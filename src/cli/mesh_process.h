// Meshes of clients are read and taken apart in a process of its own, with limits for its time and memory: whatever a
// file does to the libraries that read it, this process goes on.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <variant>

#include "core/scene.h"

namespace aurasim::cli {

/// Or why there is none.
using MeshOrWhy = std::variant<core::TriangleMesh, std::string>;

struct MeshProcess {
  std::string program = "/proc/self/exe";  ///< aurasim
  std::chrono::milliseconds limit{10'000};

  /// As config::read_mesh. Waits for it.
  MeshOrWhy read(const std::string& name, std::string_view bytes) const;
  /// As config::decompose. Waits for it.
  MeshOrWhy decompose(const core::TriangleMesh& mesh) const;
};

/// By a process of this program.
MeshOrWhy read_mesh_apart(const std::string& name, std::string_view bytes);

/// What goes between the two processes. Native byte order.
std::string mesh_bytes(const MeshOrWhy& mesh);
/// Checked; says why not if it is no such thing.
MeshOrWhy mesh_of_bytes(std::string_view bytes);

}  // namespace aurasim::cli
