// Reads model files of all formats.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

struct ReadSettings {
  std::vector<std::filesystem::path> paths;  ///< folders besides the file's own in which named files may lie
  std::optional<double> mass_kg;  ///< mass of a mesh file, which then becomes a moving body; nothing: a static
};

/// Reads a model: URDF, SDF or MJCF, recognised by the outermost element, or a mesh, recognised by its ending: OBJ,
/// STL, glTF, GLB, DAE. Reads no file outside of the model's folder and `paths`, and nothing from a network. Throws
/// BadModel.
Model read_model(const std::filesystem::path& file, const ReadSettings& settings);

/// Readers of the single formats, each based on the library of its field.
Model read_sdf(const std::filesystem::path& file, const ReadSettings& settings);
Model read_urdf(const std::filesystem::path& file, const ReadSettings& settings);
Model read_mjcf(const std::filesystem::path& file, const ReadSettings& settings);

}  // namespace aurasim::importing
