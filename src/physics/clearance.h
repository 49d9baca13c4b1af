// Distances between the scene's shapes without Bullet's margins. Boxes, cylinders and hulls are built without a margin.
// The radius of spheres and capsules, which Bullet treats as a margin, belongs to the shape.
#pragma once

#include <memory>

#include "core/clearance.h"
#include "core/scene.h"

namespace aurasim::physics {

/// Bullet's GJK over the scene's shapes. Thread-compatible: one per thread.
std::unique_ptr<core::ClearanceQuery> make_clearance_query(const core::Scene& scene);

}  // namespace aurasim::physics
