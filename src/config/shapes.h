// Shapes of a scene: how each kind is written is in the tables of shapes.cpp, and on the page of all keys.
#pragma once

#include <filesystem>
#include <optional>

#include "config/fields.h"
#include "core/scene.h"

namespace aurasim::config {

/// Exactly one kind of shape.
const KeyTable& shape_keys();

/// The shape that `field` (a map of one key) describes; mesh files are relative to `folder`.
std::optional<core::Shape> read_shape(const Field& field, const std::filesystem::path& folder);

/// Whether bodies may have it: not a triangle mesh and not a plane.
bool can_move(const core::Shape& shape);

/// Axis-aligned box around a shape, in the frame of its pose.
struct Bounds {
  core::Vec3 low = core::Vec3::Zero();
  core::Vec3 high = core::Vec3::Zero();

  core::Vec3 size() const { return high - low; }
};

/// Of a shape that can move, in its own frame.
Bounds bounds_of(const core::Shape& shape);

}  // namespace aurasim::config
