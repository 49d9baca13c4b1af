#include "dds/mesh_cache.h"

#include <utility>

namespace aurasim::dds {
namespace {

std::size_t bytes_of(const core::TriangleMesh& mesh) {
  return mesh.points.size() * sizeof(mesh.points[0]) + mesh.triangles.size() * sizeof(mesh.triangles[0]);
}

}  // namespace

bool MeshCache::add(std::uint64_t hash, core::TriangleMesh mesh) {
  if (const auto known = entries_.find(hash); known != entries_.end()) {
    known->second.released = false;  // brought again: somebody is about to ask for it
    known->second.added = ++additions_;
    return true;
  }
  const std::size_t bytes = bytes_of(mesh);
  if (!make_room(bytes)) return false;
  entries_.emplace(hash, Entry{std::move(mesh), bytes, ++additions_, false});
  bytes_ += bytes;
  return true;
}

bool MeshCache::add_spare(std::uint64_t hash, core::TriangleMesh mesh) {
  if (entries_.contains(hash)) return true;
  const bool added = add(hash, std::move(mesh));
  release(hash);
  return added;
}

bool MeshCache::make_room(std::size_t bytes) {
  if (bytes > limits_.bytes) return false;
  while (entries_.size() >= limits_.meshes || bytes_ > limits_.bytes - bytes) {
    auto oldest = entries_.end();
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      const bool older = oldest == entries_.end() || entry->second.added < oldest->second.added;
      if (entry->second.released && older) oldest = entry;
    }
    if (oldest == entries_.end()) return false;
    bytes_ -= oldest->second.bytes;
    entries_.erase(oldest);
  }
  return true;
}

const core::TriangleMesh* MeshCache::find(std::uint64_t hash) const {
  const auto found = entries_.find(hash);
  return found == entries_.end() ? nullptr : &found->second.mesh;
}

void MeshCache::release(std::uint64_t hash) {
  if (const auto found = entries_.find(hash); found != entries_.end()) found->second.released = true;
}

void MeshCache::retain(std::uint64_t hash) {
  if (const auto found = entries_.find(hash); found != entries_.end()) found->second.released = false;
}

void MeshCache::release_all() {
  for (auto& [hash, entry] : entries_) entry.released = true;
}

std::vector<std::uint64_t> MeshCache::hashes() const {
  std::vector<std::uint64_t> hashes;
  for (const auto& [hash, entry] : entries_) hashes.push_back(hash);
  return hashes;
}

}  // namespace aurasim::dds
