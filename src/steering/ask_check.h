// The range of a declared field, in words and for values.
#pragma once

#include <string>

#include "steering/ask.h"

namespace aurasim::steering {

/// Text of the values that the field allows, e.g. "0.001 to 1e+06 kg".
std::string allowed(const Field& field);

/// The refusal of a value; empty: it is in the field's range. `path`: the kind of the ask, and of the shape within it.
std::string problem_with(std::string_view path, const Field& field, double value);
std::string problem_with(std::string_view path, const Field& field, const core::Vec3& value);
std::string problem_with(std::string_view path, const Field& field, const core::Quat& value);
std::string problem_with(std::string_view path, const Field& field, const std::string& value);

}  // namespace aurasim::steering
