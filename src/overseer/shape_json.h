// Converts shapes to JSON (docs/viewer.md).
#pragma once

#include <nlohmann/json.hpp>

#include "core/scene.h"

namespace aurasim::overseer {

nlohmann::json shape_to_json(const core::Shape& shape);

}  // namespace aurasim::overseer
