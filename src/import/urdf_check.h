// What sdformat does not say of a URDF file: it turns URDF into SDF, drops what SDF has no element for, and tells of
// errors on its log alone.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// Throws BadModel with all that is wrong with the file's links, joints and numbers, each with its line.
void check_urdf(const std::filesystem::path& file);

/// Adds what was dropped: mimic joints, transmissions, soft limits, links without a mass.
void tell_of_urdf(const std::filesystem::path& file, Model& model);

}  // namespace aurasim::importing
