// The scene of a run as it has grown, as an observer knows it, to cast rays at.
#pragma once

#include <cstdint>
#include <optional>

#include "core/scene.h"
#include "dds/scene_additions_bus.h"
#include "overseer/world_watch.h"
#include "physics/ray_scene.h"

namespace aurasim::cli::agent {

/// Used by one thread.
class SeenScene {
 public:
  /// Both outlive it.
  SeenScene(dds::Participant& participant, const overseer::WorldWatch& watch);

  /// Takes in what has been added.
  void look();
  /// Knows all kinds of bodies with lower ids than this.
  std::size_t prototypes() const { return scene_.prototypes.size(); }
  const physics::RayScene& rays() const { return *rays_; }
  /// Are all orders up to this one in it, of those that change the scene?
  bool has_all_up_to(std::uint64_t order) const { return added_ >= order; }

 private:
  void begin();
  bool has_meshes_of(const core::Order& order);

  const overseer::WorldWatch& watch_;
  dds::SceneAdditionsReader additions_reader_;
  dds::MeshReader meshes_;
  std::optional<dds::SceneAdditions> additions_;
  std::uint64_t added_ = 0;  ///< sequence of the last one of them
  std::uint64_t map_version_ = 0;
  core::Scene scene_;
  std::optional<physics::RayScene> rays_;
};

}  // namespace aurasim::cli::agent
