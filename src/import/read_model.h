// Model files of all formats.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

struct ReadSettings {
  std::vector<std::filesystem::path> paths;  ///< folders besides the file's own in which files that it names may lie
  std::optional<double> mass_kg;             ///< of a mesh file, which then is a body that moves
};

/// URDF, SDF or MJCF, told by the outermost element; or a mesh by its ending: OBJ, STL, glTF, GLB, DAE. Reads no file
/// outside of the model's folder and `paths`, and nothing from a network. Throws BadModel.
Model read_model(const std::filesystem::path& file, const ReadSettings& settings);

/// The formats of description, each with its own library.
Model read_sdf(const std::filesystem::path& file, const ReadSettings& settings);
Model read_urdf(const std::filesystem::path& file, const ReadSettings& settings);
Model read_mjcf(const std::filesystem::path& file, const ReadSettings& settings);

}  // namespace aurasim::importing
