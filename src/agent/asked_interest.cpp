#include "agent/asked_interest.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include "steering/json_fields.h"

namespace aurasim::agent {
namespace {

using nlohmann::json;
using steering::vector_of;

void check_count(std::size_t found, std::size_t most, const std::string& field) {
  if (found > most) steering::refuse(field, std::to_string(found), fmt::format("at most {}", most));
}

template <class T>
void sort_and_unite(std::vector<T>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

void add_prototypes(const std::string& pattern, const core::Scene& scene, std::vector<core::PrototypeId>& to) {
  bool found = false;
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < scene.prototypes.size(); ++i) {
    names.push_back(scene.prototypes[i].name);
    if (::fnmatch(pattern.c_str(), names.back().c_str(), 0) != 0) continue;
    to.push_back(core::PrototypeId{i});
    found = true;
  }
  if (!found)
    steering::refuse("patterns", '"' + pattern + '"',
                     fmt::format("patterns of these names: {}", fmt::join(names, ", ")));
}

core::WorldBox box_of(const json& json) {
  const core::WorldBox box{vector_of(json, "low"), vector_of(json, "high")};
  const bool is_box = (box.low.array() <= box.high.array()).all() &&
                      box.low.cwiseAbs().maxCoeff() <= core::kFarthestBox_m &&
                      box.high.cwiseAbs().maxCoeff() <= core::kFarthestBox_m;
  if (!is_box) steering::refuse("boxes", json.dump(), fmt::format("low <= high, within {} m", core::kFarthestBox_m));
  return box;
}

core::Interest selection_of(const json& asked, const core::Scene& scene) {
  core::Interest selection;
  selection.every = static_cast<std::uint32_t>(steering::whole_of(asked, "every", 0, core::kMostStatesBetween));
  selection.all = asked.value("all", false);
  selection.contacts = asked.value("contacts", false);
  selection.joints = asked.value("joints", false);
  const json bodies = asked.value("bodies", json::array()), boxes = asked.value("boxes", json::array());
  check_count(bodies.size(), core::kMostWantedBodies, "bodies");
  check_count(boxes.size(), core::kMostWantedBoxes / 2, "boxes");  // half of the boxes, because sensors need some, too
  for (const json& id : bodies) selection.bodies.push_back(core::BodyId{id.get<std::uint64_t>()});
  for (const std::string& pattern : asked.value("patterns", std::vector<std::string>{})) {
    add_prototypes(pattern, scene, selection.prototypes);
  }
  for (const json& box : boxes) selection.boxes.push_back(box_of(box));
  sort_and_unite(selection.bodies);
  sort_and_unite(selection.prototypes);
  return selection;
}

Mount mount_of(const json& json, const std::string& field) {
  Mount mount;
  if (const auto body = json.find("body"); body != json.end() && !body->is_null()) {
    mount.carrier = core::BodyId{body->get<std::uint64_t>()};
  }
  mount.X_CS.p_WB = vector_of(json, "p");
  const auto q = json.value("q", std::vector<double>{1, 0, 0, 0});
  const double length = q.size() == 4 ? std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) : 0;
  if (!(length > 1e-9 && length < 1e9))
    steering::refuse(field + ".q", json.value("q", nlohmann::json()).dump(), "w x y z, not 0");
  mount.X_CS.q_WB = core::Quat(q[0], q[1], q[2], q[3]).normalized();
  return mount;
}

std::vector<core::Vec3> directions_of(const json& json, const std::string& field) {
  const auto numbers = json.value("directions", std::vector<double>{});
  if (numbers.empty() || numbers.size() % 3 != 0)
    steering::refuse(field + ".directions", std::to_string(numbers.size()), "n x 3");
  check_count(numbers.size() / 3, kMostRays, field + ".directions");
  std::vector<core::Vec3> directions;
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    const core::Vec3 direction(numbers[i], numbers[i + 1], numbers[i + 2]);
    if (!direction.allFinite() || direction.norm() < 1e-9 || direction.norm() > 1e9) {
      steering::refuse(field + ".directions", fmt::format("row {}", i / 3), "finite numbers, not all 0");
    }
    directions.push_back(direction.normalized());
  }
  return directions;
}

FanSpec fan_of(const json& json) {
  FanSpec fan{mount_of(json, "fans"), directions_of(json, "fans"),
              steering::number_of(json, "range", 1e-3, kFarthestRay_m, "fans"), 1};
  if (json.contains("every")) {
    fan.every = static_cast<std::int64_t>(steering::whole_of(json, "every", 1, core::kMostStatesBetween, "fans"));
  }
  return fan;
}

TriggerSpec trigger_of(const json& json) {
  TriggerSpec trigger{mount_of(json, "triggers"), core::Vec3::Zero(), 0};
  if (json.contains("radius")) {
    trigger.radius_m = steering::number_of(json, "radius", 1e-3, kFarthestRay_m, "triggers");
    return trigger;
  }
  trigger.half_extents = vector_of(json, "size") / 2;
  const bool is_box = trigger.half_extents.minCoeff() > 0 && trigger.half_extents.maxCoeff() <= kFarthestRay_m;
  if (!is_box) steering::refuse("triggers.size", json.value("size", nlohmann::json()).dump(), "three lengths > 0");
  return trigger;
}

}  // namespace

AskedInterest asked_interest(const json& asked, const core::Scene& scene) {
  AskedInterest interest{selection_of(asked, scene), {}, {}};
  const json fans = asked.value("fans", json::array()), triggers = asked.value("triggers", json::array());
  check_count(fans.size(), kMostFans, "fans");
  check_count(triggers.size(), kMostTriggers, "triggers");
  for (const json& fan : fans) interest.fans.push_back(fan_of(fan));
  for (const json& trigger : triggers) interest.triggers.push_back(trigger_of(trigger));
  const core::Interest& selection = interest.selection;
  const bool is_empty = !selection.all && selection.bodies.empty() && selection.prototypes.empty() &&
                        selection.boxes.empty() && fans.empty() && triggers.empty();
  if (is_empty) steering::refuse("interest", "nothing", "all, bodies, patterns, boxes, fans or triggers");
  return interest;
}

}  // namespace aurasim::agent
