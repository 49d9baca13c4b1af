#include "messages/aura_columns.h"

#include <cmath>
#include <limits>

#include "aurasim.h"
#include "core/aura_precision.h"
#include "messages/bearable.h"
#include "messages/columns.h"
#include "messages/packed_rotation.h"

namespace aurasim::messages {

using core::AuraBatch;
using core::AuraRecord;
using core::value_of;

namespace {

/// An aura names its audience by one octet.
constexpr std::size_t kMostAudiences = 256;

using MaybeError = std::optional<WireError>;

bool fits_into_grains(const core::Vec3& p) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  return (p.cwiseAbs().array() / core::kPositionGrain_m < kMost).all();
}

void put_floats(const core::Vec3& v, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

core::Vec3 floats_at(const std::vector<float>& column, std::size_t i) {
  return column.empty() ? core::Vec3(core::Vec3::Zero())
                        : core::Vec3(column[3 * i], column[3 * i + 1], column[3 * i + 2]);
}

/// Rounds up to float, because a body must not be faster, or push harder, than its aura promises.
float rounded_up(double x) {
  const auto nearest = static_cast<float>(x);
  return nearest < x ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}

void encode_positions(const std::vector<AuraRecord>& updates, wire::AuraBatch& out) {
  out.p_WB().clear();
  out.grains_WB().clear();
  const auto fits = [](const AuraRecord& a) { return fits_into_grains(a.pose.p_WB); };
  if (std::ranges::all_of(updates, fits)) {
    fill_wide<3>(out.grains_WB(), updates, [](const AuraRecord& a, std::int32_t* to) {
      for (int i = 0; i < 3; ++i)
        to[i] = static_cast<std::int32_t>(std::lround(a.pose.p_WB[i] / core::kPositionGrain_m));
    });
  } else {
    fill_wide<3>(out.p_WB(), updates, [](const AuraRecord& a, double* to) { put_vector(a.pose.p_WB, to); });
  }
}

void encode_motion(const AuraBatch& batch, wire::AuraBatch& out) {
  const std::vector<AuraRecord>& updates = batch.updates;
  out.v_WB().clear();
  out.w_WB().clear();
  out.speed_m_s().clear();
  const auto rests = [](const AuraRecord& a) { return a.v_WB.isZero(0) && a.w_WB.isZero(0); };
  if (!std::ranges::all_of(updates, rests)) {
    fill_wide<3>(out.v_WB(), updates, [](const AuraRecord& a, float* to) { put_floats(a.v_WB, to); });
    fill_wide<3>(out.w_WB(), updates, [](const AuraRecord& a, float* to) { put_floats(a.w_WB, to); });
  }
  const auto as_the_top = [&](const AuraRecord& a) { return a.speed_m_s == batch.top_speed_m_s; };
  if (!std::ranges::all_of(updates, as_the_top)) {
    fill(out.speed_m_s(), updates, [](const AuraRecord& a) { return rounded_up(a.speed_m_s); });
  }
}

/// Encodes each distinct audience once. Beyond kMostAudiences, an aura goes to all listeners, which is never wrong.
void encode_audiences(const std::vector<AuraRecord>& updates, wire::AuraBatch& out) {
  out.audience().clear();
  std::vector<core::Audience>& distinct = out.audience_regions();
  distinct.clear();
  const auto for_all = [](const AuraRecord& a) { return a.audience == core::kAllListeners; };
  if (std::ranges::all_of(updates, for_all)) return;
  distinct.push_back(core::kAllListeners);
  fill(out.audience(), updates, [&](const AuraRecord& a) -> std::uint8_t {
    auto known = std::ranges::find(distinct, a.audience);
    if (known == distinct.end()) {
      if (distinct.size() == kMostAudiences) return 0;
      known = distinct.insert(known, a.audience);
    }
    return static_cast<std::uint8_t>(known - distinct.begin());
  });
}

/// Encodes the columns that only some auras need.
void encode_exceptions(const AuraBatch& batch, wire::AuraBatch& out) {
  out.elsewhere_row().clear();
  out.elsewhere_host().clear();
  out.elsewhere_stamp().clear();
  out.unborn_row().clear();
  out.unborn_birth().clear();
  for (std::uint32_t i = 0; i < batch.updates.size(); ++i) {
    const AuraRecord& a = batch.updates[i];
    if (a.host != batch.source || a.stamp != batch.stamp) {
      out.elsewhere_row().push_back(i);
      out.elsewhere_host().push_back(value_of(a.host));
      out.elsewhere_stamp().push_back(a.stamp);
    }
    if (a.birth > a.stamp) {
      out.unborn_row().push_back(i);
      out.unborn_birth().push_back(a.birth);
    }
  }
}

bool is_empty_or(std::size_t size, std::size_t rows) { return size == 0 || size == rows; }

MaybeError check_column_shapes(const wire::AuraBatch& in) {
  const std::size_t rows = in.id().size();
  if (std::max({rows, in.elsewhere_row().size(), in.unborn_row().size()}) > kMaxRows ||
      in.audience_regions().size() > kMostAudiences) {
    return WireError::kTooLarge;
  }
  const bool fits =
      same_rows(rows, {{in.epoch().size()},
                       {in.prototype().size()},
                       {in.flags().size()},
                       {in.p_WB().size() + in.grains_WB().size(), 3},
                       {in.rotation_WB().size()}}) &&
      is_empty_or(in.p_WB().size(), 3 * rows) && is_empty_or(in.v_WB().size(), 3 * rows) &&
      in.w_WB().size() == in.v_WB().size() && is_empty_or(in.speed_m_s().size(), rows) &&
      is_empty_or(in.audience().size(), rows) &&
      same_rows(in.elsewhere_row().size(), {{in.elsewhere_host().size()}, {in.elsewhere_stamp().size()}}) &&
      in.unborn_row().size() == in.unborn_birth().size();
  return fits ? MaybeError{} : WireError::kLength;
}

MaybeError check_column_values(const wire::AuraBatch& in, const Expected& expected) {
  using namespace bearable;
  if (!all_finite(in.p_WB()) || !all_finite(in.v_WB()) || !all_finite(in.w_WB()) || !all_finite(in.speed_m_s())) {
    return WireError::kNotFinite;
  }
  if (std::ranges::any_of(in.flags(), [](std::uint8_t flags) { return (flags & ~core::kAuraAll) != 0; })) {
    return WireError::kEnum;
  }
  if (!std::ranges::all_of(in.rotation_WB(), [](std::uint64_t bits) { return unpacked_rotation(bits).has_value(); })) {
    return WireError::kRotation;
  }
  const auto rows = static_cast<std::uint32_t>(in.id().size());
  const auto is_known = [&](std::uint8_t audience) { return audience < in.audience_regions().size(); };
  const auto not_later = [&](std::int64_t stamp) { return stamp <= in.stamp(); };
  const auto soon = [&](std::int64_t birth) { return birth - kMostStatesToBirth <= in.stamp(); };
  const bool in_range = none_negative(in.speed_m_s()) && all_body_ids(in.id()) && all_within(in.p_WB(), kFarthest_m) &&
                        all_within(in.v_WB(), kFastest_m_s) && all_within(in.w_WB(), kFastestSpin_rad_s) &&
                        all_within(in.speed_m_s(), kFastestReach_m_s) && all_below(in.epoch(), kMostEpochs) &&
                        std::ranges::all_of(in.audience(), is_known) &&
                        std::ranges::all_of(in.elsewhere_stamp(), not_later) && none_negative(in.unborn_birth()) &&
                        std::ranges::all_of(in.unborn_birth(), soon) &&
                        all_below(in.prototype(), expected.prototype_count) && all_below(in.elsewhere_row(), rows) &&
                        all_below(in.elsewhere_host(), expected.region_count) && none_negative(in.elsewhere_stamp()) &&
                        all_below(in.unborn_row(), rows);
  return in_range ? MaybeError{} : WireError::kRange;
}

core::Vec3 position_at(const wire::AuraBatch& in, std::size_t i) {
  if (!in.p_WB().empty()) return vector_at(in.p_WB(), i);
  const std::int32_t* grains = in.grains_WB().data() + 3 * i;
  return core::Vec3(grains[0], grains[1], grains[2]) * core::kPositionGrain_m;
}

AuraRecord aura_at(const wire::AuraBatch& in, std::size_t i) {
  return {.id = static_cast<core::BodyId>(in.id()[i]),
          .epoch = in.epoch()[i],
          .host = static_cast<core::RegionId>(in.source()),
          .prototype = static_cast<core::PrototypeId>(in.prototype()[i]),
          .flags = in.flags()[i],
          .stamp = in.stamp(),
          .birth = 0,
          .pose = {.p_WB = position_at(in, i), .q_WB = *unpacked_rotation(in.rotation_WB()[i])},
          .v_WB = floats_at(in.v_WB(), i),
          .w_WB = floats_at(in.w_WB(), i),
          .speed_m_s = in.speed_m_s().empty() ? in.top_speed_m_s() : in.speed_m_s()[i],
          .audience = in.audience().empty() ? core::kAllListeners : in.audience_regions()[in.audience()[i]]};
}

}  // namespace

void encode_auras(const AuraBatch& batch, wire::AuraBatch& out) {
  const std::vector<AuraRecord>& updates = batch.updates;
  fill(out.id(), updates, [](const AuraRecord& a) { return value_of(a.id); });
  fill(out.epoch(), updates, [](const AuraRecord& a) { return a.epoch; });
  fill(out.prototype(), updates, [](const AuraRecord& a) { return value_of(a.prototype); });
  fill(out.flags(), updates, [](const AuraRecord& a) { return a.flags; });
  encode_positions(updates, out);
  fill(out.rotation_WB(), updates, [](const AuraRecord& a) { return packed(a.pose.q_WB); });
  encode_motion(batch, out);
  encode_audiences(updates, out);
  encode_exceptions(batch, out);
}

std::optional<WireError> check_auras(const wire::AuraBatch& in, const Expected& expected) {
  if (const auto error = check_column_shapes(in)) return error;
  return check_column_values(in, expected);
}

std::vector<AuraRecord> decode_auras(const wire::AuraBatch& in) {
  std::vector<AuraRecord> updates;
  updates.reserve(in.id().size());
  for (std::size_t i = 0; i < in.id().size(); ++i) updates.push_back(aura_at(in, i));
  for (std::size_t k = 0; k < in.elsewhere_row().size(); ++k) {
    AuraRecord& aura = updates[in.elsewhere_row()[k]];
    aura.host = static_cast<core::RegionId>(in.elsewhere_host()[k]);
    aura.stamp = in.elsewhere_stamp()[k];
  }
  for (std::size_t k = 0; k < in.unborn_row().size(); ++k) updates[in.unborn_row()[k]].birth = in.unborn_birth()[k];
  return updates;
}

}  // namespace aurasim::messages
