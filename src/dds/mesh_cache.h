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
  // Of one source, those given up not counted.
  std::size_t meshes_of_source = std::numeric_limits<std::size_t>::max();
  std::size_t bytes_of_source = std::numeric_limits<std::size_t>::max();
};

class MeshCache {
 public:
  explicit MeshCache(const MeshCacheLimits& limits = {}) : limits_(limits) {}

  /// False if there is no room for it beside those that are still needed. Whoever brings more than a source may loses
  /// the oldest of its own that nobody has asked for yet.
  bool add(std::uint64_t hash, core::TriangleMesh mesh, std::uint64_t source = 0);
  /// Likewise; of one that nobody is about to ask for.
  bool add_spare(std::uint64_t hash, core::TriangleMesh mesh, std::uint64_t source = 0);
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
    std::uint64_t source = 0;
    bool released = false;
    bool asked = false;  ///< retained
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
