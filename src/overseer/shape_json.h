// Converts shapes and poses to JSON (docs/viewer.md), and back with everything checked.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/scene.h"

namespace aurasim::overseer {

nlohmann::json shape_to_json(const core::Shape& shape);

/// A field that is missing, of another type, or out of its range; what() names it.
class BadField : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Each of these functions throws BadField.
const nlohmann::json& field(const nlohmann::json& json, const char* name);
/// Refuses an object with fields other than `names`.
void only(const nlohmann::json& json, const std::vector<const char*>& names);
/// Returns a number that is finite and within 1e7 of zero.
double number_of(const nlohmann::json& json, const char* name);
std::int64_t whole_of(const nlohmann::json& json, const char* name, std::int64_t low, std::int64_t high);
std::string text_of(const nlohmann::json& json, const char* name, std::size_t longest);
core::Vec3 vector_of(const nlohmann::json& json, const char* name);
/// Returns the pose in fields p (required) and q (optional, [w, x, y, z], normalised).
core::Pose pose_in(const nlohmann::json& json);
core::Shape read_shape(const nlohmann::json& json);

}  // namespace aurasim::overseer
