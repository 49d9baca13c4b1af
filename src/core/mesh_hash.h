// The hash by which messages name a mesh.
#pragma once

#include <cstdint>

#include "core/scene.h"

namespace aurasim::core {

/// Hash of the bits of all points and triangles, the same on every host. It finds mistakes. It is not cryptographic:
/// two meshes with one hash can be made on purpose.
std::uint64_t content_hash(const TriangleMesh& mesh);

}  // namespace aurasim::core
