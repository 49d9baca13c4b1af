#include "messages/setpoint_codec.h"

#include <algorithm>
#include <cmath>

#include "aurasim.h"
#include "core/limits.h"
#include "core/static_moves.h"
#include "messages/columns.h"
#include "messages/header_check.h"

namespace aurasim::messages {
namespace {

constexpr std::uint8_t kLetsGo = 16;
constexpr std::size_t kDriveNumbers = core::JointDrive::kNumbers;
constexpr std::size_t kMaxEffort = 5;
constexpr std::size_t kPlaceNumbers = 7;

void put_place(const core::Pose& pose, double* out) {
  put_vector(pose.p_WB, out);
  const core::Quat& q = pose.q_WB;
  out[3] = q.w(), out[4] = q.x(), out[5] = q.y(), out[6] = q.z();
}

core::StaticSetpoint static_at(const wire::Setpoints& in, std::size_t i) {
  const double* const place = &in.place()[i * kPlaceNumbers];
  const core::Quat q(place[3], place[4], place[5], place[6]);
  return {core::StaticId{in.static_id()[i]}, {core::Vec3(place[0], place[1], place[2]), q}, in.states()[i]};
}

bool is_drive(const double* drive) {
  for (std::size_t i = 0; i < kMaxEffort; ++i) {
    if (!(std::abs(drive[i]) <= core::limits::kHardestPush)) return false;
  }
  return drive[2] >= 0 && drive[3] >= 0 && drive[kMaxEffort] >= 0;  // stiffness, damping; false for NaN
}

std::optional<WireError> check_statics(const wire::Setpoints& in) {
  const std::size_t statics = in.static_id().size();
  if (statics > core::limits::kMostStaticSetpoints) return WireError::kTooLarge;
  if (!same_rows(statics, {{in.states().size()}, {in.place().size(), kPlaceNumbers}})) return WireError::kLength;
  if (!all_finite(in.place())) return WireError::kNotFinite;
  for (std::size_t i = 0; i < statics; ++i) {
    if (!core::is_sound(static_at(in, i))) return WireError::kRange;
  }
  return std::nullopt;
}

std::optional<WireError> check_rows(const wire::Setpoints& in, const Expected& expected) {
  const std::size_t bodies = in.body().size(), joints = in.joint().size();
  if (std::max(bodies, joints) > core::limits::kMostSetpoints) return WireError::kTooLarge;
  if (!same_rows(bodies, {{in.quantity().size()}, {in.value().size(), 3}}) ||
      !same_rows(joints, {{in.let_go().size()}, {in.drive().size(), kDriveNumbers}})) {
    return WireError::kLength;
  }
  if (!all_finite(in.value())) return WireError::kNotFinite;
  const auto is_quantity = [](std::uint8_t q) { return (q & ~kLetsGo) < core::kQuantities; };
  if (!std::ranges::all_of(in.quantity(), is_quantity) ||
      !std::ranges::all_of(in.let_go(), [](std::uint8_t x) { return x <= 1; })) {
    return WireError::kEnum;
  }
  if (!all_within(in.value(), core::limits::kHardestPush) || !all_body_ids(in.body()) ||
      !all_below(in.joint(), expected.joint_count)) {
    return WireError::kRange;
  }
  for (std::size_t i = 0; i < joints; ++i) {
    const double* const drive = &in.drive()[i * kDriveNumbers];
    if (std::any_of(drive, drive + kDriveNumbers, [](double x) { return std::isnan(x); })) return WireError::kNotFinite;
    if (!is_drive(drive)) return WireError::kRange;
  }
  return check_statics(in);
}

}  // namespace

void encode(const core::Setpoints& setpoints, std::uint64_t map_version, wire::Setpoints& out) {
  out.sender(setpoints.client);
  out.version(kProtocolVersion);
  out.generation(setpoints.generation);
  out.stamp(setpoints.at_step);
  out.map_version(map_version);
  out.sequence_number(setpoints.sequence);
  fill(out.body(), setpoints.bodies, [](const auto& body) { return core::value_of(body.id); });
  fill(out.quantity(), setpoints.bodies, [](const auto& body) {
    return static_cast<std::uint8_t>(static_cast<std::uint8_t>(body.quantity) | (body.value ? 0 : kLetsGo));
  });
  fill_wide<3>(out.value(), setpoints.bodies,
               [](const auto& body, double* to) { put_vector(body.value.value_or(core::Vec3::Zero()), to); });
  fill(out.joint(), setpoints.joints, [](const auto& joint) { return core::value_of(joint.id); });
  fill(out.let_go(), setpoints.joints, [](const auto& joint) { return std::uint8_t{!joint.drive}; });
  fill_wide<kDriveNumbers>(out.drive(), setpoints.joints, [](const auto& joint, double* to) {
    std::ranges::copy(joint.drive.value_or(core::JointDrive{}).numbers(), to);
  });
  fill(out.static_id(), setpoints.statics, [](const auto& fixed) { return core::value_of(fixed.id); });
  fill(out.states(), setpoints.statics, [](const auto& fixed) { return fixed.states; });
  fill_wide<kPlaceNumbers>(out.place(), setpoints.statics,
                           [](const auto& fixed, double* to) { put_place(fixed.to, to); });
}

Decoded<core::Setpoints> decode(const wire::Setpoints& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) return *error;
  if (in.stamp() < 0) return WireError::kRange;
  if (const auto error = check_rows(in, expected)) return *error;
  core::Setpoints setpoints;
  setpoints.client = in.sender();
  setpoints.sequence = in.sequence_number();
  setpoints.generation = in.generation();
  setpoints.at_step = in.stamp();
  setpoints.bodies.resize(in.body().size());
  for (std::size_t i = 0; i < setpoints.bodies.size(); ++i) {
    core::BodySetpoint& body = setpoints.bodies[i];
    body.id = core::BodyId{in.body()[i]};
    body.quantity = static_cast<core::Quantity>(in.quantity()[i] & ~kLetsGo);
    if ((in.quantity()[i] & kLetsGo) == 0) body.value = vector_at(in.value(), i);
  }
  setpoints.joints.resize(in.joint().size());
  for (std::size_t i = 0; i < setpoints.joints.size(); ++i) {
    core::JointSetpoint& joint = setpoints.joints[i];
    joint.id = core::JointId{in.joint()[i]};
    const auto numbers = std::span(in.drive()).subspan(i * kDriveNumbers).first<kDriveNumbers>();
    if (in.let_go()[i] == 0) joint.drive = core::JointDrive::of(numbers);
  }
  for (std::size_t i = 0; i < in.static_id().size(); ++i) {
    setpoints.statics.push_back(static_at(in, i));
  }
  return setpoints;
}

}  // namespace aurasim::messages
