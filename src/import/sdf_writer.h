// Writes a scene as a world of SDF.
#pragma once

#include <array>
#include <functional>

#include "import/model.h"

namespace aurasim::importing {

/// Computes the triangles of the hull of points, as triples of indices.
using TrianglesAround = std::function<std::vector<std::array<std::uint32_t, 3>>(const std::vector<core::Vec3>&)>;

struct SdfText {
  std::string xml;
  std::vector<std::pair<std::filesystem::path, std::string>> meshes;  ///< path relative to the SDF file, text (OBJ)
  std::vector<Finding> lost;                                          ///< things that SDF cannot express
};

/// Returns the text of the SDF 1.9 file at `file`. `names`: names of scene.bodies, empty for a body without one. Bodies
/// connected by joints become one model. Its links do not collide with each other if no two of them do in the scene.
SdfText sdf_text(const core::Scene& scene, const std::vector<std::string>& names, const std::filesystem::path& file,
                 const TrianglesAround& triangles_around);

}  // namespace aurasim::importing
