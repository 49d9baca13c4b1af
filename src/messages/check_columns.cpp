#include "messages/check_columns.h"

#include "aurasim.h"
#include "messages/bearable.h"
#include "messages/columns.h"

namespace aurasim::messages {

using core::Alarm;
using core::AuraRecord;
using core::BodyId;
using core::value_of;

namespace {

constexpr std::size_t kMotionNumbers = 13;

/// True when a motion (p, q, v, w; all finite) is within messages/bearable.h.
bool is_bearable(const double* motion) {
  using namespace bearable;
  const Eigen::Map<const core::Vec3> p_WB(motion), v_WB(motion + 7), w_WB(motion + 10);
  return p_WB.cwiseAbs().maxCoeff() <= kFarthest_m && v_WB.cwiseAbs().maxCoeff() <= kFastest_m_s &&
         w_WB.cwiseAbs().maxCoeff() <= kFastestSpin_rad_s;
}

}  // namespace

void encode_checks(const core::AuraBatch& batch, wire::AuraBatch& out) {
  fill(out.alarm_redo(), batch.alarms, [](const Alarm& a) { return a.redo; });
  fill(out.alarm_step(), batch.alarms, [](const Alarm& a) { return a.step; });
  fill(out.alarm_a(), batch.alarms, [](const Alarm& a) { return value_of(a.a); });
  fill(out.alarm_b(), batch.alarms, [](const Alarm& a) { return value_of(a.b); });
  fill(out.introduction_a(), batch.introductions, [](const core::Introduction& i) { return value_of(i.a); });
  fill(out.introduction_b(), batch.introductions, [](const core::Introduction& i) { return value_of(i.b); });
  fill(out.past_id(), batch.past, [](const AuraRecord& a) { return value_of(a.id); });
  fill(out.past_prototype(), batch.past, [](const AuraRecord& a) { return value_of(a.prototype); });
  fill(out.past_stamp(), batch.past, [](const AuraRecord& a) { return a.stamp; });
  fill(out.past_flags(), batch.past, [](const AuraRecord& a) { return a.flags; });
  fill_wide<kMotionNumbers>(out.past_motion(), batch.past, [](const AuraRecord& a, double* to) {
    put_vector(a.pose.p_WB, to);
    to[3] = a.pose.q_WB.w();
    put_vector(a.pose.q_WB.vec(), to + 4);
    put_vector(a.v_WB, to + 7);
    put_vector(a.w_WB, to + 10);
  });
}

std::optional<WireError> check_checks(const wire::AuraBatch& in, const Expected& expected) {
  const std::size_t alarms = in.alarm_a().size();
  const std::size_t past = in.past_id().size();
  const std::size_t introductions = in.introduction_a().size();
  if (std::max({alarms, past, introductions}) > kMaxRows) return WireError::kTooLarge;
  if (!same_rows(alarms, {{in.alarm_redo().size()}, {in.alarm_step().size()}, {in.alarm_b().size()}}) ||
      in.introduction_b().size() != introductions ||
      !same_rows(past, {{in.past_prototype().size()},
                        {in.past_stamp().size()},
                        {in.past_flags().size()},
                        {in.past_motion().size(), kMotionNumbers}})) {
    return WireError::kLength;
  }
  if (!all_finite(in.past_motion())) return WireError::kNotFinite;
  for (std::size_t i = 0; i < past; ++i) {
    const double* q = &in.past_motion()[i * kMotionNumbers + 3];
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(std::abs(norm - 1) <= kRotationTolerance)) return WireError::kRotation;
    if (!is_bearable(&in.past_motion()[i * kMotionNumbers])) return WireError::kRange;
  }
  const std::int64_t newest = in.word() > 0 ? in.stamp() : in.stamp() - 1;  // a word has the state itself, too
  const auto before_now = [newest](std::int64_t stamp) { return stamp >= 0 && stamp <= newest; };
  bool in_range = all_body_ids(in.alarm_b()) && all_body_ids(in.past_id()) &&
                  all_below(in.past_prototype(), expected.prototype_count) && none_negative(in.alarm_step()) &&
                  std::ranges::all_of(in.past_stamp(), before_now) &&
                  std::ranges::all_of(in.past_flags(), [](std::uint8_t f) { return f <= core::kAuraAsleep; });
  for (std::size_t i = 0; i < alarms; ++i) in_range = in_range && in.alarm_a()[i] < in.alarm_b()[i];
  in_range = in_range && all_below(in.introduction_b(), expected.region_count);
  for (std::size_t i = 0; i < introductions; ++i) {
    in_range = in_range && in.introduction_a()[i] < in.introduction_b()[i];
  }
  return in_range ? std::nullopt : std::optional(WireError::kRange);
}

void decode_checks(const wire::AuraBatch& in, core::AuraBatch& batch) {
  for (std::size_t i = 0; i < in.alarm_a().size(); ++i) {
    batch.alarms.push_back({in.alarm_redo()[i], in.alarm_step()[i], BodyId{in.alarm_a()[i]}, BodyId{in.alarm_b()[i]}});
  }
  for (std::size_t i = 0; i < in.introduction_a().size(); ++i) {
    batch.introductions.push_back({core::RegionId{in.introduction_a()[i]}, core::RegionId{in.introduction_b()[i]}});
  }
  for (std::size_t i = 0; i < in.past_id().size(); ++i) {
    AuraRecord& aura = batch.past.emplace_back();
    aura.id = BodyId{in.past_id()[i]};
    aura.host = batch.source;
    aura.prototype = core::PrototypeId{in.past_prototype()[i]};
    aura.stamp = in.past_stamp()[i];
    aura.flags = in.past_flags()[i];
    const double* m = &in.past_motion()[i * kMotionNumbers];
    aura.pose.p_WB = {m[0], m[1], m[2]};
    aura.pose.q_WB = core::Quat(m[3], m[4], m[5], m[6]).normalized();
    aura.v_WB = {m[7], m[8], m[9]};
    aura.w_WB = {m[10], m[11], m[12]};
  }
}

}  // namespace aurasim::messages
