#include "overseer/page_messages.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "overseer/shape_json.h"

namespace aurasim::overseer {
namespace {

using Json = nlohmann::json;
using core::value_of;

template <class Vector>
Json vector_json(const Vector& v) {
  return {v[0], v[1], v[2]};
}

template <class Quaternion>
Json rotation_json(const Quaternion& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

Json path_json(const core::StaticPath& path) {
  Json stops = Json::array();
  for (const core::PathStop& stop : path.stops) {
    stops.push_back({{"at", stop.at_s}, {"p", vector_json(stop.X_SP.p_WB)}, {"q", rotation_json(stop.X_SP.q_WB)}});
  }
  return {{"stops", std::move(stops)}, {"repeats", path.repeats}, {"smooth", path.smooth}};
}

Json place_json(const core::Pose& pose) { return {{"p", vector_json(pose.p_WB)}, {"q", rotation_json(pose.q_WB)}}; }

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// A side of a box; infinity becomes null, because JSON has no infinity.
Json side(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json durations_json(const messages::Durations& d) { return {{"p50", d.p50_ms}, {"p99", d.p99_ms}, {"max", d.max_ms}}; }

Json violations_json(const messages::Violations& violations) {
  Json counts = Json::object();
  for (const auto& [kind, count] : violations.by_kind()) counts[kind] = count;
  return counts;
}

Json listens_json(const messages::Status& status) {
  Json listens = Json::array();
  for (const core::Listened& who : status.listens_to) {
    Json one = {{"region", value_of(who.region)}, {"since", who.since}};
    if (who.introduced_by) one["introduced_by"] = value_of(*who.introduced_by);
    listens.push_back(std::move(one));
  }
  return listens;
}

Json node_json(const messages::SeenStatus& seen, double hand_offs_per_s) {
  const messages::Status& s = seen.status;
  return {{"region", value_of(s.region)},
          {"step", s.step},
          {"state", messages::name_of(s.state)},
          {"lost", seen.lost},
          {"bodies", s.bodies},
          {"awake", s.awake},
          {"hand_offs_out", s.hand_offs_out},
          {"hand_offs_in", s.hand_offs_in},
          {"hand_offs_per_s", hand_offs_per_s},
          {"violations", violations_json(s.violations)},
          {"late", s.late_collisions},
          {"missed", s.missed_collisions},
          {"redos", s.redos},
          {"listens_to", listens_json(s)},
          {"frame_ms", durations_json(s.frame)},
          {"physics_ms", durations_json(s.physics)},
          {"protocol_ms", durations_json(s.protocol)},
          {"transport_ms", durations_json(s.transport)},
          {"exchange", messages::name_of(s.exchange)},
          {"exchange_ms", durations_json(s.exchange_times)},
          {"round_trip_ms", s.round_trip_ms},
          {"real_time_factor", s.real_time_factor},
          {"largest_cluster", s.largest_cluster},
          {"lookahead", s.lookahead},
          {"text", s.text}};
}

}  // namespace

std::string hello_message(const Hello& hello) {
  Json json = {{"type", "hello"},      {"version", 1},           {"mode", hello.replay ? "replay" : "live"},
               {"scene", hello.scene}, {"step_s", hello.step_s}, {"tick_hz", hello.tick_hz}};
  if (hello.replay) {
    json["first"] = hello.first;
    json["last"] = hello.last;
    json["resets"] = hello.resets;
  }
  return text_of(json);
}

std::string scene_message(const core::Scene& scene, core::Generation generation,
                          const std::set<core::StaticId>& removed) {
  Json shapes = Json::array(), prototypes = Json::array(), statics = Json::array();
  for (const core::NamedShape& shape : scene.shapes) {
    shapes.push_back(shape_to_json(shape.shape));
    shapes.back()["name"] = shape.name;
  }
  for (const core::Prototype& prototype : scene.prototypes)
    prototypes.push_back({{"name", prototype.name}, {"shape", prototype.shape}, {"mass_kg", prototype.mass_kg}});
  for (std::size_t i = 0; i < scene.statics.size(); ++i) {
    if (removed.contains(core::StaticId{static_cast<std::uint32_t>(i)})) continue;
    const core::StaticBody& body = scene.statics[i];
    statics.push_back({{"id", i},
                       {"name", body.name},
                       {"shape", body.shape},
                       {"p", vector_json(body.pose.p_WB)},
                       {"q", rotation_json(body.pose.q_WB)}});
    if (body.path) statics.back()["path"] = path_json(*body.path);
  }
  return text_of({{"type", "scene"},
                  {"generation", generation},
                  {"name", scene.name},
                  {"gravity", vector_json(scene.gravity)},
                  {"shapes", std::move(shapes)},
                  {"prototypes", std::move(prototypes)},
                  {"statics", std::move(statics)}});
}

std::string moves_message(core::Generation generation, std::span<const core::Order> moves) {
  std::map<core::StaticId, Json> by_static;  // for each static in order of time
  for (const core::Order& order : moves) {
    const auto& move = std::get<core::MoveStatic>(order.action);
    by_static[move.id].push_back({{"step", order.at_step},
                                  {"states", move.states},
                                  {"from", place_json(move.from)},
                                  {"to", place_json(move.to)}});
  }
  Json statics = Json::array();
  for (auto& [id, list] : by_static) statics.push_back({{"id", core::value_of(id)}, {"moves", std::move(list)}});
  return text_of({{"type", "moves"}, {"generation", generation}, {"statics", std::move(statics)}});
}

std::string map_message(const core::RegionMap& map) {
  Json regions = Json::array();
  for (std::uint32_t r = 0; r < map.size(); ++r) {
    const core::Rectangle& box = map.region(core::RegionId{r});
    regions.push_back(
        {{"id", r}, {"x0", side(box.x0)}, {"y0", side(box.y0)}, {"x1", side(box.x1)}, {"y1", side(box.y1)}});
  }
  return text_of(
      {{"type", "map"}, {"map_version", fmt::format("{:016x}", map.version())}, {"regions", std::move(regions)}});
}

std::string status_message(const RunStatus& status) {
  Json nodes = Json::array();
  for (const auto& [region, seen] : status.nodes) {
    const auto rate = status.hand_offs_per_s.find(region);
    nodes.push_back(node_json(seen, rate == status.hand_offs_per_s.end() ? 0 : rate->second));
  }
  return text_of({{"type", "status"},
                  {"step", status.step},
                  {"state", status.state},
                  {"rate", status.rate},
                  {"clients", status.clients},
                  {"nodes", std::move(nodes)}});
}

std::string node_metrics(const RunStatus& status) {
  std::string text = "# HELP aurasim_nodes Nodes seen.\n# TYPE aurasim_nodes gauge\n";
  text += fmt::format("aurasim_nodes {}\n", status.nodes.size());
  const auto add = [&](const char* name, const char* type, const char* help, auto&& value) {
    text += fmt::format("# HELP aurasim_{0} {1}\n# TYPE aurasim_{0} {2}\n", name, help, type);
    for (const auto& [region, seen] : status.nodes)
      text += fmt::format("aurasim_{}{{region=\"{}\"}} {}\n", name, value_of(region), value(seen));
  };
  using Seen = messages::SeenStatus;
  add("node_up", "gauge", "1 while its proof of life has not run out.", [](const Seen& s) { return s.lost ? 0 : 1; });
  add("step", "counter", "State computed last.", [](const Seen& s) { return s.status.step; });
  add("bodies", "gauge", "Bodies hosted.", [](const Seen& s) { return s.status.bodies; });
  add("awake_bodies", "gauge", "Bodies hosted and awake.", [](const Seen& s) { return s.status.awake; });
  add("hand_offs_out_total", "counter", "Bodies handed over.", [](const Seen& s) { return s.status.hand_offs_out; });
  add("hand_offs_in_total", "counter", "Bodies adopted.", [](const Seen& s) { return s.status.hand_offs_in; });
  add("late_collisions_total", "counter", "Collisions seen late.",
      [](const Seen& s) { return s.status.late_collisions; });
  add("missed_collisions_total", "counter", "Overlaps of bodies of two nodes.",
      [](const Seen& s) { return s.status.missed_collisions; });
  add("redos_total", "counter", "How often the run has been put back and computed again.",
      [](const Seen& s) { return s.status.redos; });
  add("setpoints_heard_total", "counter", "Messages of programs that steer bodies and joints.",
      [](const Seen& s) { return s.status.setpoints_heard; });
  add("setpoints_late_total", "counter", "Those that came after their state had been computed.",
      [](const Seen& s) { return s.status.setpoints_late; });
  add("setpoints_refused_total", "counter", "Those that were refused, and setpoints that no body can bear.",
      [](const Seen& s) { return s.status.setpoints_refused; });
  add("frame_p50_ms", "gauge", "Median frame time of the last second.",
      [](const Seen& s) { return s.status.frame.p50_ms; });
  add("frame_p99_ms", "gauge", "99th percentile of the frame time.",
      [](const Seen& s) { return s.status.frame.p99_ms; });
  add("real_time_factor", "gauge", "Simulated seconds per second.",
      [](const Seen& s) { return s.status.real_time_factor; });
  text +=
      "# HELP aurasim_violations_total Warnings: limits and predictions that did not hold.\n# TYPE "
      "aurasim_violations_total counter\n";
  for (const auto& [region, seen] : status.nodes) {
    for (const auto& [kind, count] : seen.status.violations.by_kind()) {
      text += fmt::format("aurasim_violations_total{{region=\"{}\",kind=\"{}\"}} {}\n", value_of(region), kind, count);
    }
  }
  return text;
}

std::string body_message(const ViewBody& body) {
  return text_of({{"type", "body"},
                  {"slot", body.slot},
                  {"id", value_of(body.id)},
                  {"host", value_of(body.host)},
                  {"epoch", body.epoch},
                  {"prototype", value_of(body.prototype)},
                  {"p", vector_json(body.p_WB)},
                  {"q", rotation_json(body.q_WB)},
                  {"v", vector_json(body.v_WB)},
                  {"w", vector_json(body.w_WB)},
                  {"speed", body.v_WB.norm()},
                  {"awake", !body.asleep}});
}

std::string body_gone_message(core::BodyId id) {
  return text_of({{"type", "body"}, {"id", value_of(id)}, {"gone", true}});
}

}  // namespace aurasim::overseer
