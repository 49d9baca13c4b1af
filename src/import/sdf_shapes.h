// Reads collision shapes of an SDF link.
#pragma once

#include <filesystem>
#include <vector>

#include <sdf/Collision.hh>

#include "import/model.h"

namespace aurasim::importing {

/// Adds the shapes of one <collision>. Meshes are searched in the folder of the file that names them and in `paths`.
/// `link_element`: name of the link in messages.
void add_sdf_collision(const sdf::Collision& collision, const std::filesystem::path& folder,
                       const std::vector<std::filesystem::path>& paths, const std::string& link_element, Link& link,
                       Model& model);

}  // namespace aurasim::importing
