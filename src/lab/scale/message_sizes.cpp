#include "lab/scale/message_sizes.h"

#include "core/aura.h"
#include "messages/wire_bytes.h"

namespace aurasim::lab {
namespace {

constexpr std::size_t kMany = 1000;

/// A batch with the auras of `count` awake bodies, as Projection makes them.
core::AuraBatch batch_of(std::size_t count, core::AuraKind kind) {
  core::AuraBatch batch;
  batch.top_speed_m_s = 32;
  for (std::size_t i = 0; i < count; ++i) {
    core::AuraRecord& aura = batch.updates.emplace_back();
    aura.id = core::BodyId{i};
    aura.speed_m_s = 32;
    aura.pose.p_WB = core::Vec3::Constant(0.1 * static_cast<double>(i));
    if (kind != core::AuraKind::kSwept) continue;
    aura.v_WB = aura.w_WB = core::Vec3::Constant(1.0 + static_cast<double>(i));
    aura.speed_m_s = 0.01 * static_cast<double>(i);
  }
  return batch;
}

core::HandOff hand_off_of(std::size_t bodies, std::size_t contact_points) {
  core::HandOff hand_off;
  hand_off.cluster.bodies.resize(bodies);
  if (contact_points > 0) hand_off.cluster.manifolds.push_back({0, -1, 0, static_cast<std::uint32_t>(contact_points)});
  hand_off.cluster.points.assign(contact_points * core::kContactPointDoubles, 0.0);
  return hand_off;
}

/// Bytes per element, from a thousand more of them: sequences are padded, so a single one is not exact.
template <class SizeOf>
double each(SizeOf&& size_of) {
  return static_cast<double>(size_of(2 * kMany) - size_of(kMany)) / static_cast<double>(kMany);
}

}  // namespace

std::vector<ResultRow> message_sizes() {
  messages::WireBytes coder;
  const auto updates = [&](core::AuraKind kind) {
    return each([&](std::size_t n) { return coder.of(batch_of(n, kind)).size(); });
  };
  const auto deletes = [&](std::size_t n) {
    core::AuraBatch batch;
    batch.deletes.resize(n);
    return coder.of(batch).size();
  };
  const auto row = [](const char* what, auto size) {
    return ResultRow{std::string("size/") + what, "bytes", static_cast<double>(size), "B"};
  };
  return {
      row("aura batch with nothing in it", coder.of(core::AuraBatch{}).size()),
      row("each aura update, swept", updates(core::AuraKind::kSwept)),
      row("each aura update, thesis", updates(core::AuraKind::kThesis)),
      row("each aura update, tight", updates(core::AuraKind::kTight)),
      row("each aura deleted", each(deletes)),
      row("hand-off with nothing in it", coder.of(hand_off_of(0, 0)).size()),
      row("each body handed over", each([&](std::size_t n) { return coder.of(hand_off_of(n, 0)).size(); })),
      row("each contact point handed over", each([&](std::size_t n) { return coder.of(hand_off_of(1, n)).size(); }))};
}

}  // namespace aurasim::lab
