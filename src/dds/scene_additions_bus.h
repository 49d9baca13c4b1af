// Topics orders and shape: the scene additions of clients since the run began, for observers and tools that join late.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/order.h"
#include "core/scene.h"
#include "dds/mesh_cache.h"
#include "dds/participant.h"

namespace aurasim::dds {

/// All scene additions of one generation, in sequence.
struct SceneAdditions {
  core::Generation generation = 0;
  std::vector<core::Order> orders;
};

/// One per node; only the one that leads the run publishes. Used by one thread. The participant must outlive it.
class SceneAdditionsWriter {
 public:
  SceneAdditionsWriter(Participant& participant, core::RegionId region);
  ~SceneAdditionsWriter();
  void send(const SceneAdditions& additions);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Used by one thread. The participant must outlive it.
class SceneAdditionsReader {
 public:
  explicit SceneAdditionsReader(Participant& participant);
  ~SceneAdditionsReader();
  /// Returns the newest additions that arrived since the last call.
  std::optional<SceneAdditions> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Publishes again the meshes of clients that may have left, for processes that join late. Used by one thread. The
/// participant must outlive it.
class MeshWriter {
 public:
  explicit MeshWriter(Participant& participant);
  ~MeshWriter();
  /// Publishes a mesh, which stays available as long as this process lives. Returns false when topic shape takes no
  /// more.
  bool publish_again(std::uint64_t hash, const core::TriangleMesh& mesh);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Receives meshes that clients have brought. Used by one thread. The participant must outlive it.
class MeshReader {
 public:
  explicit MeshReader(Participant& participant, const MeshCacheLimits& limits = {});
  ~MeshReader();
  /// Takes in the meshes that have arrived, and returns the cache. A mesh whose content does not match its hash
  /// (core::content_hash) is refused.
  MeshCache& meshes();
  /// Returns the mesh, or null if it has not arrived (yet).
  const core::TriangleMesh* mesh(std::uint64_t hash) { return meshes().find(hash); }
  /// Number of meshes refused: not sound, not matching their hash, or without room.
  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
