// Collision shapes of an SDF link.
#pragma once

#include <filesystem>
#include <vector>

#include <sdf/Collision.hh>

#include "import/model.h"

namespace aurasim::importing {

/// Adds the shapes of one <collision>. Meshes are looked for in the folder of the file that names them and in `paths`.
/// `link_element` is how messages call the link.
void add_sdf_collision(const sdf::Collision& collision, const std::filesystem::path& folder,
                       const std::vector<std::filesystem::path>& paths, const std::string& link_element, Link& link,
                       Model& model);

}  // namespace aurasim::importing
