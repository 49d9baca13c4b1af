#include <optional>

#include "aurasim.h"
#include "messages/aura_columns.h"
#include "messages/bearable.h"
#include "messages/check_columns.h"
#include "messages/codec.h"
#include "messages/columns.h"
#include "messages/header_check.h"
#include "messages/order_columns.h"

namespace aurasim::messages {

using core::AuraBatch;
using core::BodyId;
using core::RegionId;
using core::value_of;

namespace {

using MaybeError = std::optional<WireError>;

MaybeError check_shape(const wire::AuraBatch& in) {
  const auto rows = std::max({in.deleted().size(), in.hand_off_destination().size(), in.adopted_source().size()});
  if (rows > kMaxRows) return WireError::kTooLarge;
  const bool fits = in.hand_off_destination().size() == in.hand_off_last().size() &&
                    in.adopted_source().size() == in.adopted_last().size();
  return fits ? MaybeError{} : WireError::kLength;
}

MaybeError check_values(const wire::AuraBatch& in, const Expected& expected) {
  if (!std::isfinite(in.top_speed_m_s()) || !std::isfinite(in.top_radius_m())) {
    return WireError::kNotFinite;
  }
  const bool in_range = in.stamp() >= 0 && in.top_speed_m_s() >= 0 && in.top_radius_m() >= 0 &&
                        in.top_speed_m_s() <= bearable::kFastestReach_m_s &&
                        in.top_radius_m() <= bearable::kFarthestReach_m && all_body_ids(in.deleted()) &&
                        all_below(in.hand_off_destination(), expected.region_count) &&
                        all_below(in.adopted_source(), expected.region_count);
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
  if (const auto error = check_values(in, expected)) {
    return error;
  }
  if (const auto error = check_checks(in, expected)) {
    return error;
  }
  return check_auras(in, expected);
}

}  // namespace

void encode(const AuraBatch& batch, wire::AuraBatch& out) {
  out.source(value_of(batch.source));
  out.version(kProtocolVersion);
  out.generation(batch.generation);
  out.redo(batch.redo);
  out.stamp(batch.stamp);
  out.word(batch.word);
  out.map_version(batch.map_version);
  out.full(batch.full);
  out.top_speed_m_s(batch.top_speed_m_s);
  out.top_radius_m(batch.top_radius_m);
  out.violations(batch.violations);
  encode_auras(batch, out);
  fill(out.deleted(), batch.deletes, [](BodyId id) { return value_of(id); });
  fill(out.hand_off_destination(), batch.hand_offs, [](const core::HandOffMark& m) { return value_of(m.region); });
  fill(out.hand_off_last(), batch.hand_offs, [](const core::HandOffMark& m) { return m.last_sequence; });
  fill(out.adopted_source(), batch.adopted, [](const core::HandOffMark& m) { return value_of(m.region); });
  fill(out.adopted_last(), batch.adopted, [](const core::HandOffMark& m) { return m.last_sequence; });
  encode_orders(batch.orders, out);
  encode_checks(batch, out);
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
  decode_checks(in, batch);
  batch.source = static_cast<RegionId>(in.source());
  batch.generation = in.generation();
  batch.redo = in.redo();
  batch.stamp = in.stamp();
  batch.word = in.word();
  batch.map_version = in.map_version();
  batch.full = in.full();
  batch.top_speed_m_s = in.top_speed_m_s();
  batch.top_radius_m = in.top_radius_m();
  batch.violations = in.violations();
  batch.updates = decode_auras(in);
  fill(batch.deletes, in.deleted(), [](std::uint64_t id) { return static_cast<BodyId>(id); });
  for (std::size_t i = 0; i < in.hand_off_last().size(); ++i) {
    batch.hand_offs.push_back({static_cast<RegionId>(in.hand_off_destination()[i]), in.hand_off_last()[i]});
  }
  for (std::size_t i = 0; i < in.adopted_last().size(); ++i) {
    batch.adopted.push_back({static_cast<RegionId>(in.adopted_source()[i]), in.adopted_last()[i]});
  }
  return batch;
}

}  // namespace aurasim::messages
