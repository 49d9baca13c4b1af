// Splits meshes into a few convex parts, for bodies that are not convex. The parts are computed once, by the process
// that brings the mesh. Every node receives them as one mesh with a separate piece for each part, so that all nodes
// have the same.
#pragma once

#include <string>
#include <variant>

#include "core/scene.h"

namespace aurasim::config {

/// Decomposes a mesh by hierarchical approximate convex decomposition (K. Mamou and F. Ghorbel, "A simple and efficient
/// approach for 3D mesh approximate convex decomposition", ICIP 2009). Returns a closed piece for each part, which may
/// overlap, or the reason why there is none. Takes seconds for thousands of triangles.
std::variant<core::TriangleMesh, std::string> decompose(const core::TriangleMesh& mesh);

/// Returns the hulls of the mesh's pieces (points connected by triangles), about the centre of mass of all.
core::Compound convex_parts(const core::TriangleMesh& pieces);

}  // namespace aurasim::config
