// setpoints.csv: the setpoints that programs sent for bodies, joints and statics, with the states in which they took
// effect. A later run can apply them again, on any map.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/setpoint.h"

namespace aurasim::records {

inline constexpr const char* kSetpointsFile = "setpoints.csv";
/// `what`: force, torque, velocity, spin (of body `id`: N, N m, m/s, rad/s) or drive (of joint `id`: position, speed,
/// stiffness, damping, effort, max_effort) or move (of static `id`: x y z, qw qx qy qz, states until it is there).
/// A row without numbers ends the setpoint.
inline constexpr std::string_view kSetpointsHeader = "region,step,what,id,x0,x1,x2,x3,x4,x5,x6,x7\n";

/// The quantity that the record calls `name`, or nothing if there is none of that name.
std::optional<core::Quantity> quantity_named(std::string_view name);

/// One row of the record. Numbers are written with all digits.
std::string setpoint_row(core::RegionId region, const core::BodyEffect& effect);
std::string setpoint_row(core::RegionId region, const core::JointEffect& effect);
std::string setpoint_row(core::RegionId region, const core::StaticEffect& effect);

/// Turns a recorded effect into the message that a node of another run receives. If, for one state, one host has ended
/// a setpoint and the next host reports it in effect, the report of the next host counts.
core::Setpoints as_heard_again(const core::BodyEffect& effect);
core::Setpoints as_heard_again(const core::JointEffect& effect);
core::Setpoints as_heard_again(const core::StaticEffect& effect);

/// Reads the setpoints of a region or of a whole run. Throws std::runtime_error with file and line if a line is no row
/// of setpoints.
std::vector<core::Setpoints> read_setpoints(const std::filesystem::path& file);

}  // namespace aurasim::records
