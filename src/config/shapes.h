// Reads shapes of a scene. How each kind is written is in the tables of shapes.cpp, and on the page of all keys.
#pragma once

#include <optional>

#include "config/fields.h"
#include "core/scene.h"

namespace aurasim::config {

struct SceneDraft;

/// Keys of a shape: exactly one kind of shape.
const KeyTable& shape_keys();

/// Reads the shape in `field` (a map of one key). Mesh files are relative to the draft's folder; materials of parts
/// must be in the draft already.
std::optional<core::Shape> read_shape(const Field& field, const SceneDraft& draft);

/// True when bodies may have the shape: it is neither a triangle mesh nor a plane.
bool can_move(const core::Shape& shape);

/// Thickness of a shape along the thinnest axis of its frame, m; for a compound: of its thinnest part. Infinite for
/// shapes that cannot move.
double thickness_m(const core::Shape& shape);

/// Axis-aligned box around a shape, in the frame of its pose.
struct Bounds {
  core::Vec3 low = core::Vec3::Zero();
  core::Vec3 high = core::Vec3::Zero();

  core::Vec3 size() const { return high - low; }
};

/// Bounds of a shape in its own frame. Precondition: can_move(shape).
Bounds bounds_of(const core::Shape& shape);

}  // namespace aurasim::config
