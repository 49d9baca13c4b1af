// The scene of a run with its additions, as an observer knows it, for ray casts.
#pragma once

#include <cstdint>
#include <optional>

#include "core/scene.h"
#include "dds/scene_additions_bus.h"
#include "overseer/world_watch.h"
#include "physics/ray_scene.h"

namespace aurasim::agent {

/// May be used by one thread only.
class SeenScene {
 public:
  /// `participant` and `watch` must outlive this object.
  SeenScene(dds::Participant& participant, const overseer::WorldWatch& watch);

  /// Takes in the additions that have come.
  void look();
  /// Number of known prototypes: all with lower ids are known.
  std::size_t prototypes() const { return scene_.prototypes.size(); }
  const physics::RayScene& rays() const { return *rays_; }
  /// True if all scene-changing orders up to sequence `order` are included.
  bool has_all_up_to(std::uint64_t order) const { return added_ >= order; }

 private:
  void begin();
  bool has_meshes_of(const core::Order& order);

  const overseer::WorldWatch& watch_;
  dds::SceneAdditionsReader additions_reader_;
  dds::MeshReader meshes_;
  std::optional<dds::SceneAdditions> additions_;
  std::uint64_t added_ = 0;  ///< sequence of the last order included
  std::uint64_t map_version_ = 0;
  core::Scene scene_;
  std::optional<physics::RayScene> rays_;
};

}  // namespace aurasim::agent
