// Writes a model as a scene file.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// One copy of the model in the scene.
struct Instance {
  std::string prefix;  ///< its bodies, statics and joints are named PREFIX/NAME; empty: NAME
  core::Pose X_WM;     ///< pose of the world of the model's file in the scene's world
};

struct SceneText {
  std::string yaml;
  /// Mesh files to write, which the scene names: path relative to the scene file, text (OBJ).
  std::vector<std::pair<std::filesystem::path, std::string>> meshes;
};

/// Returns the text of the scene file at `file`. Names of meshes are relative to its folder, and new meshes come into a
/// folder beside it. Numbers are written so that reading gives the same bits. All instances share their prototypes.
SceneText scene_text(const Model& model, const std::vector<Instance>& instances, const std::filesystem::path& file);

}  // namespace aurasim::importing
