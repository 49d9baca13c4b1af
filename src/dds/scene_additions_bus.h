// Topics orders and shape: what clients have added to the scene since the run began, for observers and for tools that
// come late.
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

/// Additions in sequence: all of one generation.
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
  /// The newest that came since the last call.
  std::optional<SceneAdditions> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Tells meshes of clients that may be gone, for those who come late. Used by one thread. The participant must outlive
/// it.
class MeshWriter {
 public:
  explicit MeshWriter(Participant& participant);
  ~MeshWriter();
  /// As long as this process lives. False: topic shape takes no more.
  bool tell_again(std::uint64_t hash, const core::TriangleMesh& mesh);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Meshes that clients have brought. Used by one thread. The participant must outlive it.
class MeshReader {
 public:
  explicit MeshReader(Participant& participant, const MeshCacheLimits& limits = {});
  ~MeshReader();
  /// Takes in what has come, if it is what it is called by (core::content_hash).
  MeshCache& meshes();
  /// Null if it has not come (yet).
  const core::TriangleMesh* mesh(std::uint64_t hash) { return meshes().find(hash); }
  /// Meshes that were not sound, not what they were called, or that there was no room for.
  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
