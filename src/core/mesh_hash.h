// What a mesh is called by: its content. Pure.
#pragma once

#include <cstdint>

#include "core/scene.h"

namespace aurasim::core {

/// The same for the same bits of points and triangles, on every host. Who wants to can find two meshes of one hash: it
/// tells mistakes and plain lies from the truth, not a forger with a computer.
std::uint64_t content_hash(const TriangleMesh& mesh);

}  // namespace aurasim::core
