// Injectors of a scene. A list of
//   {name, seed, rate: bodies per second, count: how many at most, start: seconds,
//    volume: {center: [x, y, z], size: [x, y, z]},
//    velocity: {min: [x, y, z], max: [x, y, z]}, random_orientation: false, prototypes: [NAME, ...]}
// Instead of `volume`, several of them that share rate and count: `volumes: [{center, size}, ...]`, or
//   per: {regions: {size: [x, y, z], height}}
//     one around the middle of every region of the scene's `layout`, its centre `height` above z = 0
//   per: {boundaries: {distance, size: [across, along, up], height}}
//     one on each side of every boundary, its centre `distance` from it
// Each region gets the same share of the bodies, each side of a region the same share of the region's.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

/// Ids of injected bodies follow those of the bodies: call after number_bodies().
void read_injectors(const Field& field, SceneDraft& draft);

}  // namespace aurasim::config
