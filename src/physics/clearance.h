// Distances between the scene's shapes as they are, without Bullet's margins: boxes, cylinders and hulls are built
// without one, and the radius of spheres and capsules, which is a margin to Bullet, belongs to the shape.
#pragma once

#include <memory>

#include "core/clearance.h"
#include "core/scene.h"

namespace aurasim::physics {

/// Bullet's GJK over the scene's shapes. Thread-compatible: one per thread.
std::unique_ptr<core::ClearanceQuery> make_clearance_query(const core::Scene& scene);

}  // namespace aurasim::physics
