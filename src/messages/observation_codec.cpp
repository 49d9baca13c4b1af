#include "messages/observation_codec.h"

#include <cmath>
#include <optional>

#include "aurasim.h"
#include "messages/bearable.h"
#include "messages/body_columns.h"
#include "messages/columns.h"
#include "messages/header_check.h"

namespace aurasim::messages {

using core::BodyId;
using core::ContactImpulse;
using core::JointState;
using core::Observation;
using core::ObservedBody;
using core::value_of;

namespace {

using MaybeError = std::optional<WireError>;

constexpr std::uint8_t kStale = 2;

MaybeError check_shape(const wire::Observation& in) {
  if (std::max({in.id().size(), in.outside().size(), in.joint().size(), in.contact_a().size()}) > kMaxRows) {
    return WireError::kTooLarge;
  }
  const bool fits = body_columns_fit(in) &&
                    same_rows(in.joint().size(), {{in.joint_position().size()}, {in.joint_speed().size()}}) &&
                    same_rows(in.contact_a().size(), {{in.contact_b().size()},
                                                      {in.contact_p().size(), 3},
                                                      {in.contact_normal().size(), 3},
                                                      {in.contact_impulse().size()}});
  return fits ? MaybeError{} : WireError::kLength;
}

bool all_are_finite(const wire::Observation& in) {
  return body_columns_are_finite(in) && all_finite(in.joint_position()) && all_finite(in.joint_speed()) &&
         all_finite(in.contact_p()) && all_finite(in.contact_normal()) && all_finite(in.contact_impulse());
}

/// True when in each pair the first is a body, and the second another body with a higher id or a static.
bool are_pairs(const std::vector<std::int64_t>& a, const std::vector<std::int64_t>& b, const Expected& expected) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool is_pair =
        a[i] >= 0 && (b[i] >= 0 ? b[i] > a[i] : static_cast<std::uint64_t>(-1 - b[i]) < expected.static_count);
    if (!is_pair) return false;
  }
  return true;
}

MaybeError check_values(const wire::Observation& in, const Expected& expected) {
  if (!all_are_finite(in)) return WireError::kNotFinite;
  const auto is_unknown = [](std::uint8_t flags) { return (flags & ~(kAsleep | kStale)) != 0; };
  if (in.kind() > static_cast<std::uint8_t>(Observation::Kind::kMadeUp) ||
      std::ranges::any_of(in.flags(), is_unknown)) {
    return WireError::kEnum;
  }
  if (!unit_quaternions(in.q_WB())) return WireError::kRotation;
  const bool in_range =
      in.stamp() >= 0 && in.sequence_number() > 0 && in.previous() >= -1 && in.previous() < in.stamp() &&
      all_body_ids(in.id()) && all_body_ids(in.outside()) && strictly_ascending(in.id()) &&
      strictly_ascending(in.outside()) && all_below(in.host(), expected.region_count) &&
      all_below(in.prototype(), expected.prototype_count) && all_below(in.joint(), expected.joint_count) &&
      all_within(in.p_WB(), bearable::kFarthest_m) && all_within(in.v_WB(), bearable::kFastest_m_s) &&
      all_within(in.w_WB(), bearable::kFastestSpin_rad_s) && all_within(in.contact_normal(), 1 + kRotationTolerance) &&
      all_within(in.contact_impulse(), bearable::kLargestOfAContact) && none_negative(in.contact_impulse()) &&
      are_pairs(in.contact_a(), in.contact_b(), expected);
  return in_range ? MaybeError{} : WireError::kRange;
}

MaybeError check(const wire::Observation& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) return error;
  if (const auto error = check_source(in, expected)) return error;
  if (const auto error = check_shape(in)) return error;
  return check_values(in, expected);
}

void put_bodies(const std::vector<ObservedBody>& bodies, wire::Observation& out) {
  put_body_columns(
      bodies, [](const ObservedBody& b) -> const core::ReplicaBody& { return b.row; }, out);
  fill(out.flags(), bodies, [](const ObservedBody& b) {
    return static_cast<std::uint8_t>((b.row.asleep ? kAsleep : 0) | (b.stale ? kStale : 0));
  });
}

void put_contacts(const std::vector<ContactImpulse>& contacts, wire::Observation& out) {
  fill(out.contact_a(), contacts, [](const ContactImpulse& c) { return c.a; });
  fill(out.contact_b(), contacts, [](const ContactImpulse& c) { return c.b; });
  fill_wide<3>(out.contact_p(), contacts, [](const ContactImpulse& c, double* to) { put_vector(c.p_W, to); });
  fill_wide<3>(out.contact_normal(), contacts, [](const ContactImpulse& c, double* to) { put_vector(c.normal_W, to); });
  fill(out.contact_impulse(), contacts, [](const ContactImpulse& c) { return c.impulse_Ns; });
}

}  // namespace

void encode(const Observation& observation, wire::Observation& out) {
  out.source(value_of(observation.source));
  out.version(kProtocolVersion);
  out.generation(observation.generation);
  out.redo(observation.redo);
  out.stamp(observation.stamp);
  out.map_version(observation.map_version);
  out.sequence_number(observation.sequence);
  out.previous(observation.previous);
  out.kind(static_cast<std::uint8_t>(observation.kind));
  out.scene_order(observation.scene_order);
  put_bodies(observation.bodies, out);
  fill(out.outside(), observation.outside, [](BodyId id) { return value_of(id); });
  fill(out.joint(), observation.joints, [](const JointState& j) { return value_of(j.id); });
  fill(out.joint_position(), observation.joints, [](const JointState& j) { return j.position; });
  fill(out.joint_speed(), observation.joints, [](const JointState& j) { return j.speed; });
  put_contacts(observation.contacts, out);
}

Decoded<Observation> decode(const wire::Observation& in, const Expected& expected) {
  if (const auto error = check(in, expected)) return *error;
  Observation observation;
  observation.source = static_cast<core::RegionId>(in.source());
  observation.generation = in.generation();
  observation.redo = in.redo();
  observation.stamp = in.stamp();
  observation.map_version = in.map_version();
  observation.sequence = in.sequence_number();
  observation.previous = in.previous();
  observation.kind = static_cast<Observation::Kind>(in.kind());
  observation.scene_order = in.scene_order();
  observation.bodies.reserve(in.id().size());
  for (std::size_t i = 0; i < in.id().size(); ++i) {
    observation.bodies.push_back({body_at(in, i), (in.flags()[i] & kStale) != 0});
  }
  for (const std::uint64_t id : in.outside()) observation.outside.push_back(static_cast<BodyId>(id));
  for (std::size_t i = 0; i < in.joint().size(); ++i) {
    observation.joints.push_back(
        {static_cast<core::JointId>(in.joint()[i]), in.joint_position()[i], in.joint_speed()[i]});
  }
  for (std::size_t i = 0; i < in.contact_a().size(); ++i) {
    observation.contacts.push_back({in.contact_a()[i], in.contact_b()[i], vector_at(in.contact_p(), i),
                                    vector_at(in.contact_normal(), i), in.contact_impulse()[i]});
  }
  return observation;
}

}  // namespace aurasim::messages
