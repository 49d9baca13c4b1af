// Mechanisms: bodies that joints bind together.
#pragma once

#include <span>
#include <vector>

#include "core/ids.h"
#include "core/joint.h"

namespace aurasim::core {

/// A body of a mechanism, and the body of the lowest id in it.
struct BoundBody {
  BodyId body{}, first{};
};

/// All bodies that have one of `which` of the joints to another body. Ascending id.
std::vector<BoundBody> mechanisms_of(std::span<const JointSpec> joints, std::span<const JointId> which);

}  // namespace aurasim::core
