// Meshes that pages have sent, by the hash of their bytes. Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <variant>

#include "core/scene.h"

namespace aurasim::overseer {

inline constexpr std::size_t kLargestMeshFile = std::size_t{16} << 20U;

class ShapeStore {
 public:
  struct Stored {
    std::uint64_t hash = 0;
    std::size_t points = 0;
    std::size_t triangles = 0;
  };
  /// `name` says the format (OBJ, STL, glTF). Returns why not, if it is refused.
  std::variant<Stored, std::string> add(const std::string& name, std::string_view bytes);
  /// Null if there is none.
  std::shared_ptr<const core::TriangleMesh> find(std::uint64_t hash) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<const core::TriangleMesh>> meshes_;
  std::size_t points_ = 0;
};

}  // namespace aurasim::overseer
