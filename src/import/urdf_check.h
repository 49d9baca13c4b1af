// Reports problems of a URDF file that sdformat does not: it converts URDF to SDF, drops elements that SDF does not
// have, and reports errors only in its log.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// Throws BadModel with all that is wrong with the file's links, joints and numbers, each with its line.
void check_urdf(const std::filesystem::path& file);

/// Adds findings about elements that sdformat drops: mimic joints, transmissions, soft limits, links without a mass.
void tell_of_urdf(const std::filesystem::path& file, Model& model);

}  // namespace aurasim::importing
