#include "client/observation.h"

#include <cmath>

#include "client/answers.h"
#include "client/columns.h"

namespace aurasim::client {
namespace {

using nlohmann::json;

json mount_json(const Mount& mount) {
  return {{"body", mount.body ? json(*mount.body) : json(nullptr)}, {"p", mount.position}, {"q", mount.rotation}};
}

json fan_json(const RayFan& fan) {
  json asked = mount_json(fan.mount);
  asked["directions"] = fan.directions;
  asked["range"] = fan.range_m;
  asked["every"] = fan.every;
  return asked;
}

json trigger_json(const Trigger& trigger) {
  json asked = mount_json(trigger.mount);
  if (trigger.radius_m != 0) {
    asked["radius"] = trigger.radius_m;
  } else {
    asked["size"] = trigger.size;
  }
  return asked;
}

Columns rows_of(const Columns& columns, const json& head, const char* key) {
  return columns.with_rows(head.value(key, std::size_t{0}));
}

void take(Columns& columns, Contacts& contacts) {
  columns.take(contacts.a);
  columns.take(contacts.b);
  columns.take(contacts.positions, 3);
  columns.take(contacts.normals, 3);
  columns.take(contacts.impulses);
}

void take(Columns& columns, Joints& joints) {
  columns.take(joints.ids);
  columns.take(joints.positions);
  columns.take(joints.speeds);
}

void take(Columns& columns, FanHits& fan) {
  columns.take(fan.objects);
  columns.take(fan.distances);
  columns.take(fan.positions, 3);
  columns.take(fan.normals, 3);
}

}  // namespace

std::vector<double> RayFan::grid(double azimuth_from, double azimuth_to, int columns, double elevation_from,
                                 double elevation_to, int rows) {
  const auto between = [](double from, double to, int i, int count) {
    return count > 1 ? from + (to - from) * i / (count - 1) : (from + to) / 2;
  };
  std::vector<double> directions;
  for (int row = 0; row < rows; ++row) {
    const double up = between(elevation_from, elevation_to, row, rows);
    for (int column = 0; column < columns; ++column) {
      const double around = between(azimuth_from, azimuth_to, column, columns);
      directions.insert(directions.end(),
                        {std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up)});
    }
  }
  return directions;
}

json interest_json(const Interest& interest) {
  json boxes = json::array(), fans = json::array(), triggers = json::array();
  for (const WorldBox& box : interest.boxes) boxes.push_back({{"low", box.low}, {"high", box.high}});
  for (const RayFan& fan : interest.fans) fans.push_back(fan_json(fan));
  for (const Trigger& trigger : interest.triggers) triggers.push_back(trigger_json(trigger));
  return {{"do", "observe"},
          {"every", interest.every},
          {"all", interest.all},
          {"bodies", interest.bodies},
          {"patterns", interest.patterns},
          {"boxes", std::move(boxes)},
          {"contacts", interest.contacts},
          {"joints", interest.joints},
          {"fans", std::move(fans)},
          {"triggers", std::move(triggers)}};
}

Observation observation_of(const Message& answer) {
  const json& head = answer.head;
  Observation observation;
  Columns columns(answer.body, head.value("rows", std::size_t{0}));
  take_bodies(answer, columns, observation.bodies);
  observation.redo = head.value("redo", 0U);
  observation.skipped = head.value("skipped", std::uint64_t{0});
  observation.silent = head.value("silent", std::vector<std::uint32_t>{});
  columns = rows_of(columns, head, "missing");
  columns.take(observation.missing);
  columns = rows_of(columns, head, "contacts");
  take(columns, observation.contacts);
  columns = rows_of(columns, head, "joints");
  take(columns, observation.joints);
  for (const json& said : head.value("fans", json::array())) {
    FanHits& fan = observation.fans.emplace_back();
    fan.cast = said.value("cast", false);
    fan.complete = said.value("complete", false);
    columns = rows_of(columns, said, "rays");
    take(columns, fan);
  }
  for (const json& said : head.value("triggers", json::array())) {
    TriggerEvents& trigger = observation.triggers.emplace_back();
    trigger.complete = said.value("complete", false);
    columns = rows_of(columns, said, "inside");
    columns.take(trigger.inside);
    columns = rows_of(columns, said, "entered");
    columns.take(trigger.entered);
    columns = rows_of(columns, said, "left");
    columns.take(trigger.left);
  }
  return observation;
}

}  // namespace aurasim::client
