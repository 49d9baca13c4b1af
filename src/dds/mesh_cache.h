// Keeps clients' meshes, by the hash of their content, until no order can name them any more. Behaves equally on every
// node: a mesh that an order may still name is never dropped, and meshes already made into a shape of the scene are
// dropped first when room is needed.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "core/scene.h"

namespace aurasim::dds {

struct MeshCacheLimits {
  std::size_t meshes = std::numeric_limits<std::size_t>::max();
  std::size_t bytes = std::numeric_limits<std::size_t>::max();  ///< bytes of points and triangles
  // Limits for one source; released meshes are not counted.
  std::size_t meshes_of_source = std::numeric_limits<std::size_t>::max();
  std::size_t bytes_of_source = std::numeric_limits<std::size_t>::max();
};

class MeshCache {
 public:
  explicit MeshCache(const MeshCacheLimits& limits = {}) : limits_(limits) {}

  /// Adds a mesh. Returns false if there is no room beside the meshes that are still needed. A source that exceeds its
  /// limit loses its own oldest mesh that no order has asked for yet.
  bool add(std::uint64_t hash, core::TriangleMesh mesh, std::uint64_t source = 0);
  /// Adds a mesh that no order is about to name. Returns false if there is no room.
  bool add_spare(std::uint64_t hash, core::TriangleMesh mesh, std::uint64_t source = 0);
  /// Returns the mesh, or null if it is not here or was dropped. Valid until the next add().
  const core::TriangleMesh* find(std::uint64_t hash) const;
  /// Marks a mesh as droppable, because its shape has been made. Lasts until the mesh is asked for again.
  void release(std::uint64_t hash);
  void retain(std::uint64_t hash);
  /// Marks all meshes as droppable: no order under way needs any.
  void release_all();
  /// Hashes of all meshes here, ascending.
  std::vector<std::uint64_t> hashes() const;

 private:
  struct Entry {
    core::TriangleMesh mesh;
    std::size_t bytes = 0;
    std::uint64_t added = 0;  ///< order of adding: higher is later
    std::uint64_t source = 0;
    bool released = false;
    bool asked = false;  ///< an order has asked for it since it was added
  };
  using Entries = std::map<std::uint64_t, Entry>;
  bool make_room(std::size_t bytes);
  bool make_room_of(std::uint64_t source, std::size_t bytes);
  template <class Which>
  Entries::iterator oldest(Which which);
  void erase(Entries::iterator entry);

  MeshCacheLimits limits_;
  Entries entries_;
  std::size_t bytes_ = 0;
  std::uint64_t additions_ = 0;
};

}  // namespace aurasim::dds
