// Meshes as a few convex parts, for bodies that are not convex. Found once, by whoever brings the mesh; every node gets
// the parts as one mesh with a separate piece for each, so that all nodes have the same.
#pragma once

#include <string>
#include <variant>

#include "core/scene.h"

namespace aurasim::config {

/// Hierarchical approximate convex decomposition (K. Mamou and F. Ghorbel, "A simple and efficient approach for 3D mesh
/// approximate convex decomposition", ICIP 2009), or why there is none. A closed piece for each part; they may overlap.
/// Takes seconds for thousands of triangles.
std::variant<core::TriangleMesh, std::string> decompose(const core::TriangleMesh& mesh);

/// The hull of each piece of the mesh that is connected by its points, about the centre of mass of all.
core::Compound convex_parts(const core::TriangleMesh& pieces);

}  // namespace aurasim::config
