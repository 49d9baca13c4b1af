#include "client/answers.h"

#include <cmath>
#include <limits>

namespace aurasim::client {
namespace {

using nlohmann::json;

template <class T>
std::optional<T> optional_of(const json& head, const char* key) {
  const auto found = head.find(key);
  if (found == head.end() || found->is_null()) return std::nullopt;
  return found->get<T>();
}

}  // namespace

Bodies bodies_of(const Message& answer) {
  Bodies bodies;
  Columns columns(answer.body, answer.head.value("rows", std::size_t{0}));
  take_bodies(answer, columns, bodies);
  return bodies;
}

void take_bodies(const Message& answer, Columns& columns, Bodies& bodies) {
  bodies.step = answer.head.value("step", std::int64_t{0});
  bodies.time_s = answer.head.value("time_s", 0.0);
  bodies.generation = answer.head.value("generation", 0U);
  bodies.exact = answer.head.value("exact", false);
  columns.take(bodies.ids);
  columns.take(bodies.positions, 3);
  columns.take(bodies.rotations, 4);
  columns.take(bodies.linear_velocities, 3);
  columns.take(bodies.angular_velocities, 3);
  columns.take(bodies.regions);
  columns.take(bodies.epochs);
  columns.take(bodies.prototypes);
  columns.take(bodies.asleep);
  columns.take(bodies.under_way);
}

RunInfo info_of(const json& head) {
  RunInfo info;
  info.file = head.value("file", "");
  info.scene = head.value("scene", "");
  info.key = head.value("key", "");
  info.domain = head.value("domain", 0U);
  info.step_s = head.value("step_s", 0.0);
  info.tick_hz = head.value("tick_hz", 0.0);
  info.lookahead = head.value("lookahead", 0);
  info.sync = head.value("sync", "");
  info.joints = head.value("joints", std::vector<std::string>{});
  info.prototypes = head.value("prototypes", std::vector<std::string>{});
  for (const json& box : head.value("regions", json::array())) info.regions.push_back(box_of(box));
  return info;
}

std::vector<NodeStatus> nodes_of(const json& head) {
  std::vector<NodeStatus> nodes;
  for (const json& said : head.value("nodes", json::array())) {
    NodeStatus node;
    node.region = said.value("region", 0U);
    node.state = said.value("state", "");
    node.pid = said.value("pid", 0U);
    node.step = said.value("step", std::int64_t{0});
    node.generation = said.value("generation", 0U);
    node.bodies = said.value("bodies", std::uint64_t{0});
    node.awake = said.value("awake", std::uint64_t{0});
    node.foreign_auras = said.value("foreign_auras", std::uint64_t{0});
    node.hand_offs_out = said.value("hand_offs_out", std::uint64_t{0});
    node.hand_offs_in = said.value("hand_offs_in", std::uint64_t{0});
    node.violations = said.value("violations", std::uint64_t{0});
    node.redos = said.value("redos", 0U);
    node.setpoints_heard = said.value("setpoints_heard", std::uint64_t{0});
    node.setpoints_late = said.value("setpoints_late", std::uint64_t{0});
    node.setpoints_refused = said.value("setpoints_refused", std::uint64_t{0});
    node.frame_ms_p50 = said.value("frame_ms_p50", 0.0);
    node.frame_ms_p99 = said.value("frame_ms_p99", 0.0);
    node.real_time_factor = said.value("real_time_factor", 0.0);
    node.rate = said.value("rate", 1.0);
    node.box = box_of(said.value("box", json::array()));
    node.dead = said.value("dead", std::vector<std::uint32_t>{});
    node.text = said.value("text", "");
    nodes.push_back(std::move(node));
  }
  return nodes;
}

Acknowledgement acknowledgement_of(const json& head) {
  Acknowledgement done;
  done.step = head.value("step", std::int64_t{0});
  done.body = optional_of<std::uint64_t>(head, "body");
  done.fixed = optional_of<std::uint32_t>(head, "static");
  done.text = head.value("text", "");
  return done;
}

RayHit ray_hit_of(const json& head) {
  RayHit ray;
  ray.hit = head.value("hit", false);
  ray.complete = head.value("complete", false);
  ray.step = head.value("step", std::int64_t{0});
  ray.body = optional_of<std::uint64_t>(head, "body");
  ray.fixed = optional_of<std::uint32_t>(head, "static");
  ray.distance_m = std::numeric_limits<double>::infinity();
  if (!ray.hit) return ray;
  ray.position = head.value("p", Vec3{});
  ray.normal = head.value("normal", Vec3{});
  ray.distance_m = head.value("distance_m", 0.0);
  return ray;
}

SavedWorld saved_world_of(const json& head) {
  return {head.value("step", std::int64_t{0}), head.value("file", ""), head.value("parts", std::vector<std::string>{})};
}

std::vector<double> box_of(const json& sides) {
  std::vector<double> box;
  for (const json& side : sides) {
    const double beyond = std::numeric_limits<double>::infinity() * (box.size() < 2 ? -1 : 1);
    box.push_back(side.is_number() ? side.get<double>() : beyond);
  }
  return box;
}

}  // namespace aurasim::client
