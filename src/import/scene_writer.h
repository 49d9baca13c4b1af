// A model as a scene file of ours.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// One copy of the model in the scene.
struct Instance {
  std::string prefix;  ///< PREFIX/NAME are the names of its bodies, statics and joints; empty: NAME
  core::Pose X_WM;     ///< where the world of the model's file is in that of the scene
};

struct SceneText {
  std::string yaml;
  /// Meshes that the scene names and that have to be written: path relative to the scene file, text (OBJ).
  std::vector<std::pair<std::filesystem::path, std::string>> meshes;
};

/// The scene file that is to lie at `file`: names of meshes are relative to its folder, and new meshes come into a
/// folder beside it. Numbers are written so that reading gives the same bits. All instances share their prototypes.
SceneText scene_text(const Model& model, const std::vector<Instance>& instances, const std::filesystem::path& file);

}  // namespace aurasim::importing
