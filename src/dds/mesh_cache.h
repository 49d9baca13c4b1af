// Meshes of clients, by the hash of their content, until they are needed no more. The same on every node: what an order
// may still name is never given up, and what has been made into a shape of the scene goes first when room is needed.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "core/scene.h"

namespace aurasim::dds {

struct MeshCacheLimits {
  std::size_t meshes = std::numeric_limits<std::size_t>::max();
  std::size_t bytes = std::numeric_limits<std::size_t>::max();  ///< of points and triangles
};

class MeshCache {
 public:
  explicit MeshCache(const MeshCacheLimits& limits = {}) : limits_(limits) {}

  /// False if there is no room for it beside those that are still needed.
  bool add(std::uint64_t hash, core::TriangleMesh mesh);
  /// Likewise; of one that nobody is about to ask for.
  bool add_spare(std::uint64_t hash, core::TriangleMesh mesh);
  /// Null if there is none, or none any more. Valid until the next add().
  const core::TriangleMesh* find(std::uint64_t hash) const;
  /// Its shape has been made; it may be given up. Until it is asked for again:
  void release(std::uint64_t hash);
  void retain(std::uint64_t hash);
  /// Nothing that is under way needs any of them.
  void release_all();
  /// Ascending.
  std::vector<std::uint64_t> hashes() const;

 private:
  struct Entry {
    core::TriangleMesh mesh;
    std::size_t bytes = 0;
    std::uint64_t added = 0;  ///< the higher the later
    bool released = false;
  };
  bool make_room(std::size_t bytes);

  MeshCacheLimits limits_;
  std::map<std::uint64_t, Entry> entries_;
  std::size_t bytes_ = 0;
  std::uint64_t additions_ = 0;
};

}  // namespace aurasim::dds
