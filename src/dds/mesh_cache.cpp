#include "dds/mesh_cache.h"

#include <utility>

namespace aurasim::dds {
namespace {

std::size_t bytes_of(const core::TriangleMesh& mesh) {
  return mesh.points.size() * sizeof(mesh.points[0]) + mesh.triangles.size() * sizeof(mesh.triangles[0]);
}

}  // namespace

bool MeshCache::add(std::uint64_t hash, core::TriangleMesh mesh, std::uint64_t source) {
  if (const auto known = entries_.find(hash); known != entries_.end()) {
    known->second.released = false;  // brought again: an order is about to ask for it
    known->second.added = ++additions_;
    return true;
  }
  const std::size_t bytes = bytes_of(mesh);
  if (!make_room_of(source, bytes) || !make_room(bytes)) return false;
  entries_.emplace(hash, Entry{std::move(mesh), bytes, ++additions_, source, false, false});
  bytes_ += bytes;
  return true;
}

bool MeshCache::add_spare(std::uint64_t hash, core::TriangleMesh mesh, std::uint64_t source) {
  if (entries_.contains(hash)) return true;
  const bool added = add(hash, std::move(mesh), source);
  release(hash);
  return added;
}

bool MeshCache::make_room(std::size_t bytes) {
  if (bytes > limits_.bytes) return false;
  while (entries_.size() >= limits_.meshes || bytes_ > limits_.bytes - bytes) {
    const auto first = oldest([](const Entry& entry) { return entry.released; });
    if (first == entries_.end()) return false;
    erase(first);
  }
  return true;
}

bool MeshCache::make_room_of(std::uint64_t source, std::size_t bytes) {
  if (bytes > limits_.bytes_of_source) return false;
  for (;;) {
    std::size_t meshes_now = 0, bytes_now = 0;
    for (const auto& [hash, entry] : entries_) {
      if (entry.source != source || entry.released) continue;
      ++meshes_now;
      bytes_now += entry.bytes;
    }
    if (meshes_now < limits_.meshes_of_source && bytes_now <= limits_.bytes_of_source - bytes) return true;
    const auto first =
        oldest([source](const Entry& entry) { return entry.source == source && !entry.released && !entry.asked; });
    if (first == entries_.end()) return false;
    erase(first);
  }
}

template <class Which>
MeshCache::Entries::iterator MeshCache::oldest(Which which) {
  auto oldest = entries_.end();
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    const bool older = oldest == entries_.end() || entry->second.added < oldest->second.added;
    if (which(entry->second) && older) oldest = entry;
  }
  return oldest;
}

void MeshCache::erase(Entries::iterator entry) {
  bytes_ -= entry->second.bytes;
  entries_.erase(entry);
}

const core::TriangleMesh* MeshCache::find(std::uint64_t hash) const {
  const auto found = entries_.find(hash);
  return found == entries_.end() ? nullptr : &found->second.mesh;
}

void MeshCache::release(std::uint64_t hash) {
  if (const auto found = entries_.find(hash); found != entries_.end()) found->second.released = true;
}

void MeshCache::retain(std::uint64_t hash) {
  if (const auto found = entries_.find(hash); found != entries_.end()) {
    found->second.released = false;
    found->second.asked = true;
  }
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
