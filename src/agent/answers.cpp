#include "agent/answers.h"

#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/sync_mode_names.h"
#include "cut/saved_parts.h"

namespace aurasim::agent {
namespace {

using nlohmann::json;

/// Appends one column of all bodies.
template <class T, class Values>
void add_column(std::string& bytes, const std::vector<WorldBody>& bodies, const Values& values_of) {
  for (const WorldBody& body : bodies) {
    const auto values = values_of(body);
    static_assert(std::is_same_v<typename decltype(values)::value_type, T>);
    bytes.append(reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size());
  }
}

template <class T, class Vector>
std::array<T, 3> three(const Vector& v) {
  return {v.x(), v.y(), v.z()};
}

json list(const core::Vec3& v) { return {v.x(), v.y(), v.z()}; }

json box_json(const core::Rectangle& box) {
  json sides = json::array();
  for (const double side : {box.x0, box.y0, box.x1, box.y1}) {
    sides.push_back(std::isfinite(side) ? json(side) : json(nullptr));
  }
  return sides;
}

void add_object(json& to, const std::optional<core::ObjectRef>& object) {
  if (!object) return;
  if (*object >= 0) {
    to["body"] = *object;
  } else {
    to["static"] = -1 - *object;
  }
}

[[noreturn]] void refuse(const steering::Delivery& delivery) {
  throw Problem(delivery.timed_out ? Kind::kTimedOut : Kind::kRefused, delivery.text);
}

}  // namespace

client::Message state_message(const WorldState& state, double step_s) {
  const std::vector<WorldBody>& bodies = state.bodies;
  client::Message message;
  message.head = {{"step", state.step},
                  {"time_s", static_cast<double>(state.step) * step_s},
                  {"generation", state.generation},
                  {"exact", state.exact},
                  {"rows", bodies.size()}};
  std::string& bytes = message.body;
  using Bytes = std::array<std::uint8_t, 1>;
  using Words = std::array<std::uint32_t, 1>;
  add_column<std::uint64_t>(bytes, bodies, [](const WorldBody& b) { return std::array{core::value_of(b.row.id)}; });
  add_column<double>(bytes, bodies, [](const WorldBody& b) { return three<double>(b.row.p_WB); });
  add_column<float>(bytes, bodies, [](const WorldBody& b) {
    const Eigen::Quaternionf& q = b.row.q_WB;
    return std::array<float, 4>{q.w(), q.x(), q.y(), q.z()};
  });
  add_column<float>(bytes, bodies, [](const WorldBody& b) { return three<float>(b.row.v_WB); });
  add_column<float>(bytes, bodies, [](const WorldBody& b) { return three<float>(b.row.w_WB); });
  add_column<std::uint32_t>(bytes, bodies, [](const WorldBody& b) { return Words{core::value_of(b.row.host)}; });
  add_column<std::uint32_t>(bytes, bodies, [](const WorldBody& b) { return Words{b.row.epoch}; });
  add_column<std::uint32_t>(bytes, bodies, [](const WorldBody& b) { return Words{core::value_of(b.row.prototype)}; });
  add_column<std::uint8_t>(bytes, bodies, [](const WorldBody& b) { return Bytes{b.row.asleep}; });
  add_column<std::uint8_t>(bytes, bodies, [](const WorldBody& b) { return Bytes{b.under_way}; });
  return message;
}

json nodes_json(const std::map<core::RegionId, messages::SeenStatus>& nodes) {
  json all = json::array();
  for (const auto& [region, seen] : nodes) {
    const messages::Status& status = seen.status;
    json dead = json::array();
    for (const core::RegionId other : status.dead) dead.push_back(core::value_of(other));
    all.push_back({{"region", core::value_of(region)},
                   {"state", seen.lost && !seen.has_ended() ? "lost" : messages::name_of(status.state)},
                   {"pid", status.pid},
                   {"step", status.step},
                   {"generation", status.generation},
                   {"bodies", status.bodies},
                   {"awake", status.awake},
                   {"foreign_auras", status.foreign_auras},
                   {"hand_offs_out", status.hand_offs_out},
                   {"hand_offs_in", status.hand_offs_in},
                   {"violations", status.violations.total()},
                   {"redos", status.redos},
                   {"setpoints_heard", status.setpoints_heard},
                   {"setpoints_late", status.setpoints_late},
                   {"setpoints_refused", status.setpoints_refused},
                   {"frame_ms_p50", status.frame.p50_ms},
                   {"frame_ms_p99", status.frame.p99_ms},
                   {"real_time_factor", status.real_time_factor},
                   {"rate", status.rate},
                   {"box", box_json(status.footprint)},
                   {"dead", std::move(dead)},
                   {"text", status.text}});
  }
  return {{"nodes", std::move(all)}};
}

json info_json(const RunLink& run) {
  const config::Launch& launch = run.launch();
  json prototypes = json::array(), regions = json::array(), joints = json::array();
  for (const core::Prototype& prototype : launch.scene.prototypes) prototypes.push_back(prototype.name);
  for (const core::JointSpec& joint : launch.scene.joints) joints.push_back(joint.name);
  for (std::uint32_t r = 0; r < launch.regions.size(); ++r) {
    regions.push_back(box_json(launch.regions.region(core::RegionId{r})));
  }
  return {{"file", launch.file.string()},
          {"scene", launch.scene.name},
          {"key", run.member() ? run.member()->name : std::string()},
          {"domain", launch.dds.domain},
          {"step_s", launch.step_s()},
          {"tick_hz", launch.observe.tick_hz},
          {"lookahead", launch.lookahead()},
          {"sync", core::name_of(launch.time.sync)},
          {"prototypes", std::move(prototypes)},
          {"joints", std::move(joints)},
          {"regions", std::move(regions)}};
}

json act_json(const steering::Delivery& delivery) {
  if (!delivery.done && delivery.timed_out) refuse(delivery);
  json act = {{"step", delivery.at_step}, {"text", delivery.text}};
  if (!delivery.done) act["refused"] = delivery.text;
  add_object(act, delivery.object);
  return act;
}

json ray_json(const steering::Delivery& delivery) {
  if (!delivery.done) refuse(delivery);
  json ray = {{"step", delivery.at_step}, {"hit", delivery.object.has_value()}, {"complete", delivery.silent.empty()}};
  if (!delivery.object) return ray;
  add_object(ray, delivery.object);
  ray["p"] = list(delivery.p_W);
  ray["normal"] = list(delivery.normal_W);
  ray["distance_m"] = delivery.distance_m;
  return ray;
}

json save_json(const steering::Delivery& delivery, const std::string& name) {
  if (!delivery.done) refuse(delivery);
  const std::string file = cut::put_together(delivery.files, name).file;
  return {{"step", delivery.at_step},
          {"file", file},
          {"parts", file.empty() ? delivery.files : std::vector<std::string>{}}};
}

}  // namespace aurasim::agent
