// The arithmetic that soft/lanes.h declares. Only for the files that compile it for one set of instructions each.
#pragma once

#include "physics/soft/kernel_joints.h"
#include "physics/soft/kernel_moves.h"
#include "physics/soft/kernel_patches.h"
#include "physics/soft/kernel_points.h"

namespace aurasim::physics::soft {
namespace {

constexpr Kernel kThis = {move,         warm_start,       solve,           bounce,  look_at_joints, begin_joints,
                          solve_joints, farthest<double>, farthest<float>, tighten, reach};

}  // namespace
}  // namespace aurasim::physics::soft
