#include "overseer/shape_store.h"

#include <algorithm>

#include "config/meshes.h"
#include "core/mesh_hash.h"

namespace aurasim::overseer {
namespace {

constexpr std::size_t kMostMeshes = 256;
constexpr std::size_t kMostPointsOfAll = 10'000'000;  // limit for all meshes together

ShapeStore::Stored summary_of(std::uint64_t hash, const core::TriangleMesh& mesh) {
  return {hash, mesh.points.size(), mesh.triangles.size()};
}

}  // namespace

std::variant<ShapeStore::Stored, std::string> ShapeStore::add(const std::string& name, std::string_view bytes) {
  if (bytes.size() > kLargestMeshFile) return "it is larger than 16 MiB";
  const std::uint64_t of_file = config::content_hash(bytes);
  if (const auto stored = known(of_file)) return *stored;
  auto read = read_(name, bytes);
  if (auto* why = std::get_if<std::string>(&read)) return std::move(*why);
  auto mesh = std::make_shared<const core::TriangleMesh>(std::get<core::TriangleMesh>(std::move(read)));
  const std::uint64_t hash = core::content_hash(*mesh);
  const std::lock_guard lock(mutex_);
  if (mesh->points.size() > kMostPointsOfAll) return "it has too many points";
  if (!meshes_.contains(hash)) {
    make_room(mesh->points.size());
    points_ += mesh->points.size();
    meshes_[hash] = {mesh, ++questions_};
  }
  if (of_files_.size() >= 4 * kMostMeshes) of_files_.clear();
  of_files_[of_file] = hash;
  return summary_of(hash, *mesh);
}

std::optional<ShapeStore::Stored> ShapeStore::known(std::uint64_t of_file) const {
  std::uint64_t hash = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto file = of_files_.find(of_file);
    if (file == of_files_.end()) return std::nullopt;
    hash = file->second;
  }
  const auto mesh = find(hash);
  return mesh == nullptr ? std::nullopt : std::optional(summary_of(hash, *mesh));
}

void ShapeStore::make_room(std::size_t points) {
  while (!meshes_.empty() && (meshes_.size() >= kMostMeshes || points_ + points > kMostPointsOfAll)) {
    const auto oldest = std::min_element(meshes_.begin(), meshes_.end(),
                                         [](const auto& a, const auto& b) { return a.second.asked < b.second.asked; });
    points_ -= oldest->second.mesh->points.size();
    meshes_.erase(oldest);
  }
}

std::shared_ptr<const core::TriangleMesh> ShapeStore::find(std::uint64_t hash) const {
  const std::lock_guard lock(mutex_);
  const auto found = meshes_.find(hash);
  if (found == meshes_.end()) return nullptr;
  found->second.asked = ++questions_;
  return found->second.mesh;
}

std::size_t ShapeStore::count() const {
  const std::lock_guard lock(mutex_);
  return meshes_.size();
}

}  // namespace aurasim::overseer
