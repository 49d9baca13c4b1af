// Meshes that pages have sent, by the hash of their content. So much and no more: those that have not been asked for
// the longest go. Thread-safe.
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

/// A file's name, which says the format (OBJ, STL, glTF), and its bytes -> the mesh, or why there is none.
using MeshReader =
    std::function<std::variant<core::TriangleMesh, std::string>(const std::string& name, std::string_view bytes)>;

class ShapeStore {
 public:
  /// `read`: called by any thread, by several at once. May take long.
  explicit ShapeStore(MeshReader read) : read_(std::move(read)) {}

  struct Stored {
    std::uint64_t hash = 0;
    std::size_t points = 0;
    std::size_t triangles = 0;
  };
  /// Returns why not, if it is refused.
  std::variant<Stored, std::string> add(const std::string& name, std::string_view bytes);
  /// Null if there is none, or none any more.
  std::shared_ptr<const core::TriangleMesh> find(std::uint64_t hash) const;
  std::size_t count() const;

 private:
  struct Kept {
    std::shared_ptr<const core::TriangleMesh> mesh;
    mutable std::uint64_t asked = 0;  ///< when last, by count of questions
  };
  /// Of a file that was read before.
  std::optional<Stored> known(std::uint64_t of_file) const;
  void make_room(std::size_t points);

  MeshReader read_;
  mutable std::mutex mutex_;
  mutable std::uint64_t questions_ = 0;
  std::map<std::uint64_t, std::uint64_t> of_files_;  ///< by the hash of a file: of its mesh
  std::map<std::uint64_t, Kept> meshes_;
  std::size_t points_ = 0;
};

}  // namespace aurasim::overseer
