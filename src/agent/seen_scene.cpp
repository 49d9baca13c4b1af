#include "agent/seen_scene.h"

#include <utility>

#include "config/meshes.h"
#include "node/scene_additions.h"

namespace aurasim::agent {

SeenScene::SeenScene(dds::Participant& participant, const overseer::WorldWatch& watch)
    : watch_(watch), additions_reader_(participant), meshes_(participant) {
  begin();
}

void SeenScene::begin() {
  rays_.reset();
  scene_ = watch_.launch().scene;
  map_version_ = watch_.launch().regions.version();
  added_ = 0;
  rays_.emplace(scene_, watch_.launch().step_s());
}

bool SeenScene::has_meshes_of(const core::Order& order) {
  const auto* const defined = std::get_if<core::DefineShape>(&order.action);
  const auto* const ref = defined == nullptr ? nullptr : std::get_if<core::MeshRef>(&defined->shape);
  return ref == nullptr || meshes_.mesh(ref->hash) != nullptr;
}

/// Applies the additions in order, up to the first whose mesh has not come.
void SeenScene::look() {
  if (std::optional<dds::SceneAdditions> newest = additions_reader_.take()) {
    const bool is_another_world = additions_ && additions_->generation != newest->generation;
    additions_ = std::move(newest);
    if (is_another_world) begin();
  }
  const bool has_changed =
      map_version_ != watch_.launch().regions.version() || scene_.name != watch_.launch().scene.name;
  if (has_changed) begin();
  if (!additions_) return;
  const auto mesh = [this](const core::MeshRef& ref) -> std::optional<core::Shape> {
    const core::TriangleMesh* const found = meshes_.mesh(ref.hash);
    return found == nullptr ? std::nullopt : std::optional(config::shape_for(*found, ref.use));
  };
  for (const core::Order& order : additions_->orders) {
    if (order.sequence <= added_) continue;
    if (!has_meshes_of(order)) return;
    node::extend(scene_, order.action, mesh);
    rays_->add(order);
    added_ = order.sequence;
  }
}

}  // namespace aurasim::agent
