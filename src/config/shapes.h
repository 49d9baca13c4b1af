// Shapes of a scene. One of:
//   {sphere: {radius: 0.3}}
//   {box: {size: [1, 2, 3]}}
//   {capsule: {radius: 0.3, height: 1.4}}                 along z; height between the cap centres, or total_height
//   {cylinder: {radius: 0.3, height: 1}}                  along z
//   {convex_hull: {points: [[x, y, z], ...]}}             or {mesh: FILE, scale: 1, up: z, recentre: false}
//   {compound: {parts: [{SHAPE, position, orientation}, ...]}}     convex parts; the origin is the centre of mass
//   {mesh: {file: FILE, scale: 1, up: z}}                 triangles of an OBJ, STL or glTF file; statics only
//   {heightfield: {cell: [dx, dy], heights: [[...], ...]}}         rows from -y to +y, centred; statics only
//   {plane: {normal: [0, 0, 1], offset: 0}}               half-space below; statics only
#pragma once

#include <filesystem>
#include <optional>

#include "config/fields.h"
#include "core/scene.h"

namespace aurasim::config {

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
