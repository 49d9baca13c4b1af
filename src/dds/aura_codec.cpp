#include <optional>

#include "aurasim.h"
#include "dds/codec.h"
#include "dds/columns.h"
#include "dds/header_check.h"
#include "dds/order_columns.h"

namespace aurasim::dds {

using core::AuraBatch;
using core::AuraRecord;
using core::BodyId;
using core::RegionId;
using core::value_of;

namespace {

using MaybeError = std::optional<WireError>;

void encode_updates(const std::vector<AuraRecord>& updates, wire::AuraBatch& out) {
  fill(out.id(), updates, [](const AuraRecord& a) { return value_of(a.id); });
  fill(out.epoch(), updates, [](const AuraRecord& a) { return a.epoch; });
  fill(out.host(), updates, [](const AuraRecord& a) { return value_of(a.host); });
  fill(out.prototype(), updates, [](const AuraRecord& a) { return value_of(a.prototype); });
  fill(out.flags(), updates, [](const AuraRecord& a) { return a.flags; });
  fill(out.state_stamp(), updates, [](const AuraRecord& a) { return a.stamp; });
  fill(out.birth(), updates, [](const AuraRecord& a) { return a.birth; });
  fill_wide<3>(out.p_WB(), updates, [](const AuraRecord& a, double* to) { put_vector(a.pose.p_WB, to); });
  fill_wide<4>(out.q_WB(), updates, [](const AuraRecord& a, double* to) {
    to[0] = a.pose.q_WB.w();
    to[1] = a.pose.q_WB.x();
    to[2] = a.pose.q_WB.y();
    to[3] = a.pose.q_WB.z();
  });
  fill_wide<3>(out.v_WB(), updates, [](const AuraRecord& a, double* to) { put_vector(a.v_WB, to); });
  fill_wide<3>(out.w_WB(), updates, [](const AuraRecord& a, double* to) { put_vector(a.w_WB, to); });
  fill(out.speed_m_s(), updates, [](const AuraRecord& a) { return a.speed_m_s; });
}

MaybeError check_shape(const wire::AuraBatch& in) {
  const std::size_t rows = in.id().size();
  if (std::max({rows, in.deleted().size(), in.hand_off_destination().size(), in.dead().size(), in.claim_id().size()}) >
      kMaxRows) {
    return WireError::kTooLarge;
  }
  const bool fits = same_rows(rows, {{in.epoch().size()},
                                     {in.host().size()},
                                     {in.prototype().size()},
                                     {in.flags().size()},
                                     {in.state_stamp().size()},
                                     {in.birth().size()},
                                     {in.p_WB().size(), 3},
                                     {in.q_WB().size(), 4},
                                     {in.v_WB().size(), 3},
                                     {in.w_WB().size(), 3},
                                     {in.speed_m_s().size()}}) &&
                    in.hand_off_destination().size() == in.hand_off_last().size() &&
                    in.claim_id().size() == in.claim_epoch().size();
  return fits ? MaybeError{} : WireError::kLength;
}

MaybeError check_values(const wire::AuraBatch& in, const Expected& expected) {
  if (!std::isfinite(in.top_speed_m_s()) || !std::isfinite(in.top_radius_m()) || !all_finite(in.p_WB()) ||
      !all_finite(in.q_WB()) || !all_finite(in.v_WB()) || !all_finite(in.w_WB()) || !all_finite(in.speed_m_s())) {
    return WireError::kNotFinite;
  }
  if (std::ranges::any_of(in.flags(), [](std::uint8_t flags) { return (flags & ~core::kAuraAll) != 0; })) {
    return WireError::kEnum;
  }
  if (!unit_quaternions(in.q_WB())) {
    return WireError::kRotation;
  }
  const bool in_range = in.stamp() >= 0 && in.top_speed_m_s() >= 0 && in.top_radius_m() >= 0 &&
                        none_negative(in.speed_m_s()) && none_negative(in.state_stamp()) && none_negative(in.birth()) &&
                        all_body_ids(in.id()) && all_body_ids(in.deleted()) && all_body_ids(in.claim_id()) &&
                        all_below(in.host(), expected.region_count) && all_below(in.dead(), expected.region_count) &&
                        all_below(in.hand_off_destination(), expected.region_count) &&
                        all_below(in.prototype(), expected.prototype_count);
  return in_range ? MaybeError{} : WireError::kRange;
}

MaybeError check(const wire::AuraBatch& in, const Expected& expected) {
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

AuraRecord update_at(const wire::AuraBatch& in, std::size_t i) {
  const double* q = in.q_WB().data() + 4 * i;
  return {.id = static_cast<BodyId>(in.id()[i]),
          .epoch = in.epoch()[i],
          .host = static_cast<RegionId>(in.host()[i]),
          .prototype = static_cast<core::PrototypeId>(in.prototype()[i]),
          .flags = in.flags()[i],
          .stamp = in.state_stamp()[i],
          .birth = in.birth()[i],
          .pose = {.p_WB = vector_at(in.p_WB(), i), .q_WB = core::Quat(q[0], q[1], q[2], q[3])},
          .v_WB = vector_at(in.v_WB(), i),
          .w_WB = vector_at(in.w_WB(), i),
          .speed_m_s = in.speed_m_s()[i]};
}

}  // namespace

void encode(const AuraBatch& batch, wire::AuraBatch& out) {
  out.source(value_of(batch.source));
  out.version(kProtocolVersion);
  out.generation(batch.generation);
  out.stamp(batch.stamp);
  out.map_version(batch.map_version);
  out.full(batch.full);
  out.top_speed_m_s(batch.top_speed_m_s);
  out.top_radius_m(batch.top_radius_m);
  out.violations(batch.violations);
  encode_updates(batch.updates, out);
  fill(out.deleted(), batch.deletes, [](BodyId id) { return value_of(id); });
  fill(out.hand_off_destination(), batch.hand_offs, [](const core::HandOffMark& m) { return value_of(m.destination); });
  fill(out.hand_off_last(), batch.hand_offs, [](const core::HandOffMark& m) { return m.last_sequence; });
  fill(out.dead(), batch.dead, [](RegionId region) { return value_of(region); });
  fill(out.claim_id(), batch.claims, [](const core::BodyEpoch& claim) { return value_of(claim.id); });
  fill(out.claim_epoch(), batch.claims, [](const core::BodyEpoch& claim) { return claim.epoch; });
  encode_orders(batch.orders, out);
}

Decoded<AuraBatch> decode(const wire::AuraBatch& in, const Expected& expected) {
  if (const auto error = check(in, expected)) {
    return *error;
  }
  auto orders = decode_orders(in);
  if (!orders) {
    return WireError::kRange;
  }
  AuraBatch batch;
  batch.orders = std::move(*orders);
  batch.source = static_cast<RegionId>(in.source());
  batch.generation = in.generation();
  batch.stamp = in.stamp();
  batch.map_version = in.map_version();
  batch.full = in.full();
  batch.top_speed_m_s = in.top_speed_m_s();
  batch.top_radius_m = in.top_radius_m();
  batch.violations = in.violations();
  batch.updates.reserve(in.id().size());
  for (std::size_t i = 0; i < in.id().size(); ++i) {
    batch.updates.push_back(update_at(in, i));
  }
  fill(batch.deletes, in.deleted(), [](std::uint64_t id) { return static_cast<BodyId>(id); });
  fill(batch.dead, in.dead(), [](std::uint32_t region) { return static_cast<RegionId>(region); });
  for (std::size_t i = 0; i < in.hand_off_last().size(); ++i) {
    batch.hand_offs.push_back({static_cast<RegionId>(in.hand_off_destination()[i]), in.hand_off_last()[i]});
  }
  for (std::size_t i = 0; i < in.claim_id().size(); ++i) {
    batch.claims.push_back({static_cast<BodyId>(in.claim_id()[i]), in.claim_epoch()[i]});
  }
  return batch;
}

}  // namespace aurasim::dds
