#include "core/mesh_hash.h"

#include <bit>

#include "core/fnv1a.h"

namespace aurasim::core {
namespace {

/// Like FNV-1a, but over words of 64 bits instead of octets, because meshes are large. The shift mixes high bits into
/// low ones.
class WordHash {
 public:
  void add(std::uint64_t word) {
    hash_ = (hash_ ^ word) * Fnv1a::kPrime;
    hash_ ^= hash_ >> 29;
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = Fnv1a::kOffsetBasis;
};

}  // namespace

std::uint64_t content_hash(const TriangleMesh& mesh) {
  WordHash hash;
  hash.add(mesh.points.size());
  for (const Vec3& point : mesh.points) {
    for (int axis = 0; axis < 3; ++axis) hash.add(std::bit_cast<std::uint64_t>(point[axis]));
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) hash.add(corner);
  }
  return hash.value();
}

}  // namespace aurasim::core
