// Reads joints of an SDF model.
#pragma once

#include <map>

#include "import/model.h"
#include "import/sdf_frames.h"

namespace aurasim::importing {

/// Adds one joint. `links`: indices of the model's links by their full names.
void add_sdf_joint(const sdf::Joint& joint, const SdfScope& scope, const std::map<std::string, std::size_t>& links,
                   Model& model);

}  // namespace aurasim::importing
