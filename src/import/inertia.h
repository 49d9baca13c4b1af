// Principal axes of inertia.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

struct PrincipalInertia {
  core::Mat3 R_LB =
      core::Mat3::Identity();  ///< a rotation: columns are the axes, each as near as can be to its own of L
  core::Vec3 moments = core::Vec3::Zero();  ///< kg m^2
};

/// Of a symmetric tensor in the axes of L. One that is diagonal keeps the axes of L.
PrincipalInertia principal_inertia(const core::Mat3& tensor_L);

/// The frame B of a link, in the world.
core::Pose body_pose(const Link& link);

/// Whether three moments can be those of a body: positive, and no one above the sum of the two others.
bool is_physical(const core::Vec3& moments);

}  // namespace aurasim::importing
