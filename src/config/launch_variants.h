// Variants of a launch that was read, with one thing changed: the launch of a run that gets other regions or another
// scene.
#pragma once

#include <string>
#include <vector>

#include "config/launch.h"

namespace aurasim::config {

/// Returns the launch of a run whose nodes have chosen this exchange. Throws BadConfig.
Launch with_exchange(const Launch& launch, Exchange exchange);

/// Returns the launch with these regions, one rectangle each; infinite sides allowed. Throws BadConfig.
Launch with_regions(const Launch& launch, const std::vector<core::Rectangle>& boxes);

/// Returns the launch with the scene file of this name beside that of the launch. Throws BadConfig.
Launch with_scene(const Launch& launch, const std::string& name);

}  // namespace aurasim::config
