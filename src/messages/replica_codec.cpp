#include "messages/replica_codec.h"

#include <optional>

#include "aurasim.h"
#include "messages/body_columns.h"
#include "messages/columns.h"
#include "messages/header_check.h"

namespace aurasim::messages {

using core::BodyId;
using core::RegionId;
using core::RemovedBody;
using core::Replica;
using core::ReplicaBody;
using core::value_of;

namespace {

using MaybeError = std::optional<WireError>;

MaybeError check_shape(const wire::Replica& in) {
  if (std::max(in.id().size(), in.removed_id().size()) > kMaxRows) {
    return WireError::kTooLarge;
  }
  const bool fits = body_columns_fit(in) && in.removed_id().size() == in.removed_epoch().size();
  return fits ? MaybeError{} : WireError::kLength;
}

MaybeError check_values(const wire::Replica& in, const Expected& expected) {
  if (!body_columns_are_finite(in)) {
    return WireError::kNotFinite;
  }
  if (std::ranges::any_of(in.flags(), [](std::uint8_t flags) { return (flags & ~kAsleep) != 0; })) {
    return WireError::kEnum;
  }
  if (!unit_quaternions(in.q_WB())) {
    return WireError::kRotation;
  }
  const bool in_range = in.stamp() >= 0 && in.sequence_number() > 0 && all_body_ids(in.id()) &&
                        all_body_ids(in.removed_id()) && strictly_ascending(in.id()) &&
                        all_below(in.host(), expected.region_count) &&
                        all_below(in.prototype(), expected.prototype_count);
  return in_range ? MaybeError{} : WireError::kRange;
}

MaybeError check(const wire::Replica& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) {
    return error;
  }
  if (const auto error = check_source(in, expected)) {
    return error;
  }
  if (const auto error = check_shape(in)) {
    return error;
  }
  return check_values(in, expected);
}

}  // namespace

void encode(const Replica& replica, wire::Replica& out) {
  out.source(value_of(replica.source));
  out.version(kProtocolVersion);
  out.generation(replica.generation);
  out.stamp(replica.stamp);
  out.map_version(replica.map_version);
  out.sequence_number(replica.sequence);
  out.key_frame(replica.key_frame);
  const std::vector<ReplicaBody>& bodies = replica.bodies;
  put_body_columns(
      bodies, [](const ReplicaBody& b) -> const ReplicaBody& { return b; }, out);
  fill(out.flags(), bodies, [](const ReplicaBody& b) { return b.asleep ? kAsleep : std::uint8_t{0}; });
  fill(out.removed_id(), replica.removed, [](const RemovedBody& r) { return value_of(r.id); });
  fill(out.removed_epoch(), replica.removed, [](const RemovedBody& r) { return r.epoch; });
}

Decoded<Replica> decode(const wire::Replica& in, const Expected& expected) {
  if (const auto error = check(in, expected)) {
    return *error;
  }
  Replica replica;
  replica.source = static_cast<RegionId>(in.source());
  replica.generation = in.generation();
  replica.stamp = in.stamp();
  replica.map_version = in.map_version();
  replica.sequence = in.sequence_number();
  replica.key_frame = in.key_frame();
  replica.bodies.reserve(in.id().size());
  for (std::size_t i = 0; i < in.id().size(); ++i) {
    replica.bodies.push_back(body_at(in, i));
  }
  for (std::size_t i = 0; i < in.removed_id().size(); ++i) {
    replica.removed.push_back({static_cast<BodyId>(in.removed_id()[i]), in.removed_epoch()[i]});
  }
  return replica;
}

}  // namespace aurasim::messages
