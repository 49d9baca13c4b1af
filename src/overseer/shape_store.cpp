#include "overseer/shape_store.h"

#include "config/meshes.h"

namespace aurasim::overseer {
namespace {

constexpr std::size_t kMostMeshes = 256;
constexpr std::size_t kMostPointsOfAll = 10'000'000;  // of all meshes

ShapeStore::Stored summary_of(std::uint64_t hash, const core::TriangleMesh& mesh) {
  return {hash, mesh.points.size(), mesh.triangles.size()};
}

}  // namespace

std::variant<ShapeStore::Stored, std::string> ShapeStore::add(const std::string& name, std::string_view bytes) {
  if (bytes.size() > kLargestMeshFile) return "it is larger than 16 MiB";
  const std::uint64_t hash = config::content_hash(bytes);
  if (const auto known = find(hash)) return summary_of(hash, *known);
  auto read = config::read_mesh(name, bytes);
  if (auto* why = std::get_if<std::string>(&read)) return std::move(*why);
  auto mesh = std::make_shared<const core::TriangleMesh>(std::get<core::TriangleMesh>(std::move(read)));
  const std::lock_guard lock(mutex_);
  if (meshes_.size() >= kMostMeshes || points_ + mesh->points.size() > kMostPointsOfAll)
    return "there is no room for more";
  if (meshes_.emplace(hash, mesh).second) points_ += mesh->points.size();
  return summary_of(hash, *mesh);
}

std::shared_ptr<const core::TriangleMesh> ShapeStore::find(std::uint64_t hash) const {
  const std::lock_guard lock(mutex_);
  const auto found = meshes_.find(hash);
  return found == meshes_.end() ? nullptr : found->second;
}

}  // namespace aurasim::overseer
