// Shapes of a scene: how each kind is written is in the tables of shapes.cpp, and on the page of all keys.
#pragma once

#include <optional>

#include "config/fields.h"
#include "core/scene.h"

namespace aurasim::config {

struct SceneDraft;

/// Exactly one kind of shape.
const KeyTable& shape_keys();

/// The shape that `field` (a map of one key) describes. Mesh files are relative to the draft's folder; parts have
/// materials that the draft has by now.
std::optional<core::Shape> read_shape(const Field& field, const SceneDraft& draft);

/// Whether bodies may have it: not a triangle mesh and not a plane.
bool can_move(const core::Shape& shape);

/// How thick it is along the thinnest axis of its frame; of a compound: its thinnest part. Infinite for what cannot
/// move.
double thickness_m(const core::Shape& shape);

/// Axis-aligned box around a shape, in the frame of its pose.
struct Bounds {
  core::Vec3 low = core::Vec3::Zero();
  core::Vec3 high = core::Vec3::Zero();

  core::Vec3 size() const { return high - low; }
};

/// Of a shape that can move, in its own frame.
Bounds bounds_of(const core::Shape& shape);

}  // namespace aurasim::config
