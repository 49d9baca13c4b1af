// setpoints.csv: what programs wanted of bodies, joints and statics, in which state it took effect on them; and how a
// later run hears it again, on any map.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/setpoint.h"

namespace aurasim::node {

inline constexpr const char* kSetpointsFile = "setpoints.csv";
/// `what`: force, torque, velocity, spin (of body `id`: N, N m, m/s, rad/s) or drive (of joint `id`: position, speed,
/// stiffness, damping, effort, max_effort) or move (of static `id`: x y z, qw qx qy qz, states until it is there).
/// Without numbers: let go of.
inline constexpr std::string_view kSetpointsHeader = "region,step,what,id,x0,x1,x2,x3,x4,x5,x6,x7\n";

/// As the record calls it; nothing: there is none of that name.
std::optional<core::Quantity> quantity_named(std::string_view name);

/// With every digit.
std::string setpoint_row(core::RegionId region, const core::BodyEffect& effect);
std::string setpoint_row(core::RegionId region, const core::JointEffect& effect);
std::string setpoint_row(core::RegionId region, const core::StaticEffect& effect);

/// For a node of another run. Where one host has let go of a body and the next says what is in effect on it, that
/// counts.
core::Setpoints as_heard_again(const core::BodyEffect& effect);
core::Setpoints as_heard_again(const core::JointEffect& effect);
core::Setpoints as_heard_again(const core::StaticEffect& effect);

/// Of a region or of a whole run. Throws std::runtime_error with the file and line that is none.
std::vector<core::Setpoints> read_setpoints(const std::filesystem::path& file);

}  // namespace aurasim::node
