// A world as files: DIR/launch.yaml, DIR/scene.yaml and the meshes that it names, as `aurasim launch DIR/launch.yaml`
// takes them. DIR/interference.json has what a launch file cannot contain (interference.h).
#pragma once

#include <filesystem>

#include "lab/scenes/json.h"
#include "lab/scenes/random_ground.h"

namespace aurasim::lab {

struct World {
  Json scene;
  Json launch;
  Json interference;
  MeshTexts meshes;
};

inline constexpr const char* kLaunchFile = "launch.yaml";
inline constexpr const char* kInterferenceFile = "interference.json";

/// Makes the folder. Throws std::runtime_error when a file cannot be written.
void write_world(const World& world, const std::filesystem::path& directory);

}  // namespace aurasim::lab
