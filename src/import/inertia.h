// Computes principal axes of inertia.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

struct PrincipalInertia {
  /// A rotation: column i is the principal axis that is nearest to axis i of L.
  core::Mat3 R_LB = core::Mat3::Identity();
  core::Vec3 moments = core::Vec3::Zero();  ///< about the principal axes, kg m^2
};

/// Computes the principal inertia of a symmetric tensor in the axes of L. A diagonal tensor keeps the axes of L.
PrincipalInertia principal_inertia(const core::Mat3& tensor_L);

/// Pose of a link's frame B in the world.
core::Pose body_pose(const Link& link);

/// True when three moments are those of a possible body: positive, and none above the sum of the two others.
bool is_physical(const core::Vec3& moments);

}  // namespace aurasim::importing
