// Stores meshes that pages have sent, by the hash of their content. The size is limited: the least recently used meshes
// are dropped. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "core/scene.h"

namespace aurasim::overseer {

inline constexpr std::size_t kLargestMeshFile = std::size_t{16} << 20U;

/// Reads a mesh from a file's name, which gives the format (OBJ, STL, glTF), and its bytes. Returns the mesh or the
/// reason why there is none.
using MeshReader =
    std::function<std::variant<core::TriangleMesh, std::string>(const std::string& name, std::string_view bytes)>;

class ShapeStore {
 public:
  /// `read` is called by any thread, by several at once, and may take long.
  explicit ShapeStore(MeshReader read) : read_(std::move(read)) {}

  struct Stored {
    std::uint64_t hash = 0;
    std::size_t points = 0;
    std::size_t triangles = 0;
  };
  /// Adds a mesh file. Returns the stored mesh's description, or the reason for a refusal.
  std::variant<Stored, std::string> add(const std::string& name, std::string_view bytes);
  /// Returns a mesh; null if it was never there or was dropped.
  std::shared_ptr<const core::TriangleMesh> find(std::uint64_t hash) const;
  std::size_t count() const;

 private:
  struct Kept {
    std::shared_ptr<const core::TriangleMesh> mesh;
    mutable std::uint64_t asked = 0;  ///< counter value of the last use
  };
  /// Returns the mesh of a file that was read before. `of_file`: hash of the file.
  std::optional<Stored> known(std::uint64_t of_file) const;
  void make_room(std::size_t points);

  MeshReader read_;
  mutable std::mutex mutex_;
  mutable std::uint64_t questions_ = 0;
  std::map<std::uint64_t, std::uint64_t> of_files_;  ///< hash of a file -> hash of its mesh
  std::map<std::uint64_t, Kept> meshes_;
  std::size_t points_ = 0;
};

}  // namespace aurasim::overseer
