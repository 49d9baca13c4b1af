#include "dds/replica_codec.h"

#include <optional>

#include "aurasim.h"
#include "dds/columns.h"
#include "dds/header_check.h"

namespace aurasim::dds {

using core::BodyId;
using core::RegionId;
using core::RemovedBody;
using core::Replica;
using core::ReplicaBody;
using core::value_of;

namespace {

using MaybeError = std::optional<WireError>;

constexpr std::uint8_t kAsleep = 1;

void put_floats(const Eigen::Vector3f& v, float* out) {
  out[0] = v.x();
  out[1] = v.y();
  out[2] = v.z();
}

MaybeError check_shape(const wire::Replica& in) {
  const std::size_t rows = in.id().size();
  if (std::max(rows, in.removed_id().size()) > kMaxRows) {
    return WireError::kTooLarge;
  }
  const bool fits = same_rows(rows, {{in.epoch().size()},
                                     {in.host().size()},
                                     {in.prototype().size()},
                                     {in.flags().size()},
                                     {in.p_WB().size(), 3},
                                     {in.q_WB().size(), 4},
                                     {in.v_WB().size(), 3},
                                     {in.w_WB().size(), 3}}) &&
                    in.removed_id().size() == in.removed_epoch().size();
  return fits ? MaybeError{} : WireError::kLength;
}

MaybeError check_values(const wire::Replica& in, const Expected& expected) {
  if (!all_finite(in.p_WB()) || !all_finite(in.q_WB()) || !all_finite(in.v_WB()) || !all_finite(in.w_WB())) {
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

ReplicaBody body_at(const wire::Replica& in, std::size_t i) {
  const float* q = in.q_WB().data() + 4 * i;
  const float* v = in.v_WB().data() + 3 * i;
  const float* w = in.w_WB().data() + 3 * i;
  return {.id = static_cast<BodyId>(in.id()[i]),
          .epoch = in.epoch()[i],
          .host = static_cast<RegionId>(in.host()[i]),
          .prototype = static_cast<core::PrototypeId>(in.prototype()[i]),
          .asleep = (in.flags()[i] & kAsleep) != 0,
          .p_WB = vector_at(in.p_WB(), i),
          .q_WB = Eigen::Quaternionf(q[0], q[1], q[2], q[3]),
          .v_WB = {v[0], v[1], v[2]},
          .w_WB = {w[0], w[1], w[2]}};
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
  fill(out.id(), bodies, [](const ReplicaBody& b) { return value_of(b.id); });
  fill(out.epoch(), bodies, [](const ReplicaBody& b) { return b.epoch; });
  fill(out.host(), bodies, [](const ReplicaBody& b) { return value_of(b.host); });
  fill(out.prototype(), bodies, [](const ReplicaBody& b) { return value_of(b.prototype); });
  fill(out.flags(), bodies, [](const ReplicaBody& b) { return b.asleep ? kAsleep : std::uint8_t{0}; });
  fill_wide<3>(out.p_WB(), bodies, [](const ReplicaBody& b, double* to) { put_vector(b.p_WB, to); });
  fill_wide<4>(out.q_WB(), bodies, [](const ReplicaBody& b, float* to) {
    to[0] = b.q_WB.w();
    to[1] = b.q_WB.x();
    to[2] = b.q_WB.y();
    to[3] = b.q_WB.z();
  });
  fill_wide<3>(out.v_WB(), bodies, [](const ReplicaBody& b, float* to) { put_floats(b.v_WB, to); });
  fill_wide<3>(out.w_WB(), bodies, [](const ReplicaBody& b, float* to) { put_floats(b.w_WB, to); });
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

}  // namespace aurasim::dds
