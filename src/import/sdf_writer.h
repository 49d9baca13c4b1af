// A scene as a world of SDF.
#pragma once

#include <array>
#include <functional>

#include "import/model.h"

namespace aurasim::importing {

/// The triangles around points, as triples of indices.
using TrianglesAround = std::function<std::vector<std::array<std::uint32_t, 3>>(const std::vector<core::Vec3>&)>;

struct SdfText {
  std::string xml;
  std::vector<std::pair<std::filesystem::path, std::string>> meshes;  ///< path relative to the SDF file, text (OBJ)
  std::vector<Finding> lost;                                          ///< what SDF cannot say
};

/// SDF 1.9 that is to lie at `file`. `names` are those of scene.bodies, empty for a body without one. What joints hold
/// together is one model, whose links do not collide with each other if no two of them do in the scene.
SdfText sdf_text(const core::Scene& scene, const std::vector<std::string>& names, const std::filesystem::path& file,
                 const TrianglesAround& triangles_around);

}  // namespace aurasim::importing
