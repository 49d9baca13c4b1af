// Reads a scene file as a whole. Its keys are in the tables of scene_file.cpp and of the readers beside it, and on the
// page of all keys (docs/keys.md).
//
// Bodies without an id get the lowest free ones, in the order of the file, generators after `bodies`; the ids of
// injected bodies follow, injector by injector.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "config/errors.h"
#include "config/launch.h"
#include "config/overrides.h"
#include "config/region_layout.h"
#include "core/scene.h"

namespace aurasim::config {

/// The launch file's layout, for `layout: launch`.
struct LaunchLayout {
  bool is_known = false;  ///< false: the scene is read without a launch file
  std::optional<RegionLayout> layout;
};

struct SceneFile {
  core::Scene scene;
  std::vector<SceneSource> body_sources;      ///< as scene.bodies
  std::vector<SceneSource> injector_sources;  ///< as scene.injectors
};

/// Reads the scene in `file`, with overrides whose paths begin in the scene. Check `errors` before use.
SceneFile read_scene_file(const std::filesystem::path& file, const std::vector<Override>& overrides,
                          const LaunchLayout& launch, Errors& errors);

}  // namespace aurasim::config
