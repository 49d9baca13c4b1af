// A launch that was read, with one thing changed: what a run becomes when it gets other regions or another scene.
#pragma once

#include <string>
#include <vector>

#include "config/launch.h"

namespace aurasim::config {

/// One rectangle for each region; infinite sides allowed. Throws BadConfig.
Launch with_regions(const Launch& launch, const std::vector<core::Rectangle>& boxes);

/// The scene file of this name beside that of the launch. Throws BadConfig.
Launch with_scene(const Launch& launch, const std::string& name);

}  // namespace aurasim::config
