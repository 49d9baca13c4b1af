// World files are JSON, which is YAML: keys stay in the order in which they were written.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/body_state.h"

namespace aurasim::lab {

using Json = nlohmann::ordered_json;

/// Rounds to a tenth of a millimetre, so that the text is short and the same on every machine. Zero has no sign.
inline double rounded(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }
inline Json json_vec3(const core::Vec3& v) { return Json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())}); }

}  // namespace aurasim::lab
