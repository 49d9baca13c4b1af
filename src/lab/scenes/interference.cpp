#include "lab/scenes/interference.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "lab/scenes/json.h"
#include "lab/virtual_cluster.h"
#include "node/node.h"
#include "records/setpoint_record.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

Vec3 vec3_in(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Vec3 vec3_or_zero(const Json& map, const char* key) { return map.contains(key) ? vec3_in(map.at(key)) : Vec3::Zero(); }

core::Pose pose_in(const Json& map) { return {vec3_in(map.at("position")), core::Quat::Identity()}; }

core::BodyId body_in(const Json& json) { return core::BodyId{json.get<std::uint64_t>()}; }

/// Reads requests, and numbers the objects that orders add, as nodes will.
class RequestReader {
 public:
  explicit RequestReader(const core::Scene& scene)
      : scene_(scene),
        shapes_(scene.shapes.size()),
        prototypes_(scene.prototypes.size()),
        statics_(scene.statics.size()) {}

  Request read(const Json& order) {
    Request request;
    request.at_step = order.at("at_step");
    if (order.contains("spawn")) return spawn(request, order["spawn"]);
    if (order.contains("add_static")) return add_static(request, order["add_static"]);
    request.actions = {action_in(order)};
    return request;
  }

 private:
  core::Action action_in(const Json& order) const {
    if (order.contains("remove_body")) return core::RemoveBody{body_in(order["remove_body"])};
    if (order.contains("remove_static")) return core::RemoveStatic{static_named(order["remove_static"])};
    if (order.contains("move_static")) {
      const Json& move = order["move_static"];
      return core::MoveStatic{static_named(move.at("name")), {}, pose_in(move), move.at("states")};
    }
    if (order.contains("impulse")) {
      const Json& impulse = order["impulse"];
      return core::Impulse{body_in(impulse.at("body")), vec3_in(impulse.at("value")), {}};
    }
    const Json& velocity = order.at("set_velocity");
    core::SetVelocity action{body_in(velocity.at("body")), vec3_in(velocity.at("value")), {}};
    if (velocity.contains("spin")) action.w_WB = vec3_in(velocity["spin"]);
    return action;
  }

  Request spawn(Request request, const Json& what) {
    core::Spawn spawn{
        body_in(what.at("id")), {}, pose_in(what), vec3_or_zero(what, "velocity"), vec3_or_zero(what, "spin")};
    if (what.contains("prototype")) {
      spawn.prototype = prototype_named(what["prototype"]);
    } else {
      request.actions.push_back(core::DefineShape{core::Sphere{what.at("sphere").at("radius")}});
      request.actions.push_back(core::DefinePrototype{shapes_++, what.at("mass")});
      spawn.prototype = core::PrototypeId{prototypes_++};
    }
    request.actions.push_back(spawn);
    return request;
  }

  Request add_static(Request request, const Json& what) {
    const core::StaticId id{statics_++};
    named_[what.at("name")] = id;
    request.actions.push_back(core::DefineShape{core::Box{vec3_in(what.at("box").at("size")) / 2}});
    request.actions.push_back(core::AddStatic{id, shapes_++, pose_in(what)});
    return request;
  }

  /// A static that an order has added, or else one of the scene.
  core::StaticId static_named(const std::string& name) const {
    if (const auto added = named_.find(name); added != named_.end()) return added->second;
    const auto found = core::find_static(scene_, name);
    if (!found) throw std::runtime_error(fmt::format("no static \"{}\"", name));
    return *found;
  }

  core::PrototypeId prototype_named(const std::string& name) const {
    const auto found = std::ranges::find(scene_.prototypes, name, &core::Prototype::name);
    if (found == scene_.prototypes.end()) throw std::runtime_error(fmt::format("no prototype \"{}\"", name));
    return core::PrototypeId{static_cast<std::uint32_t>(found - scene_.prototypes.begin())};
  }

  const core::Scene& scene_;
  std::uint32_t shapes_, prototypes_, statics_;
  std::map<std::string, core::StaticId> named_;
};

core::BodySetpoint body_setpoint_in(const Json& json) {
  const auto quantity = records::quantity_named(json.at("quantity").get<std::string>());
  if (!quantity) throw std::runtime_error(fmt::format("no quantity {}", json.at("quantity").dump()));
  core::BodySetpoint body{body_in(json.at("body")), *quantity, {}};
  if (json.contains("value")) body.value = vec3_in(json["value"]);
  return body;
}

core::JointSetpoint joint_setpoint_in(const Json& json, const core::Scene& scene) {
  const auto joint = std::ranges::find(scene.joints, json.at("joint").get<std::string>(), &core::JointSpec::name);
  if (joint == scene.joints.end()) throw std::runtime_error(fmt::format("no joint {}", json.at("joint").dump()));
  core::JointSetpoint setpoint{core::JointId{static_cast<std::uint32_t>(joint - scene.joints.begin())}, {}};
  if (json.contains("drive")) {
    const auto numbers = json["drive"].get<std::array<double, core::JointDrive::kNumbers>>();
    setpoint.drive = core::JointDrive::of(numbers);
  }
  return setpoint;
}

core::StaticSetpoint static_setpoint_in(const Json& json, const core::Scene& scene) {
  const std::string name = json.at("static");
  const auto id = core::find_static(scene, name);
  if (!id) throw std::runtime_error(fmt::format("no static \"{}\"", name));
  return {*id, pose_in(json), json.at("states")};
}

Word word_in(const Json& json, const core::Scene& scene, std::uint64_t number) {
  Word word{json.at("said_step"), {json.at("client"), number, 0, json.at("at_step"), {}, {}}};
  for (const Json& body : json.at("bodies")) word.setpoints.bodies.push_back(body_setpoint_in(body));
  for (const Json& joint : json.at("joints")) word.setpoints.joints.push_back(joint_setpoint_in(joint, scene));
  for (const Json& fixed : json.value("statics", Json::array())) {
    word.setpoints.statics.push_back(static_setpoint_in(fixed, scene));
  }
  return word;
}

/// Entries of `list`, ascending by the state that `key` names.
std::vector<Json> sorted(const Json& json, const char* list, const char* key) {
  if (!json.contains(list)) return {};
  auto entries = json[list].get<std::vector<Json>>();
  std::ranges::stable_sort(entries, {}, [key](const Json& entry) { return entry.at(key).get<core::Step>(); });
  return entries;
}

/// Reads orders in the sequence in which they will be given, because the objects that they add are numbered.
Interference interference_in(const Json& json, const core::Scene& scene) {
  Interference interference;
  RequestReader reader(scene);
  for (const Json& order : sorted(json, "orders", "at_step")) interference.requests.push_back(reader.read(order));
  for (const Json& word : sorted(json, "programs", "said_step")) {
    interference.words.push_back(word_in(word, scene, interference.words.size() + 1));
  }
  return interference;
}

}  // namespace

Interference read_interference(const std::filesystem::path& file, const core::Scene& scene) {
  std::ifstream in(file);
  if (!in) return {};
  try {
    return interference_in(Json::parse(in), scene);
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), error.what()));
  }
}

void ImpatientClient::speak(node::Node& lead) {
  while (next_ < requests_.size() && requests_[next_].at_step <= lead.protocol().earliest_effect()) ask(lead);
}

void ImpatientClient::speak_after(const core::WorldCut& world, node::Node& lead) {
  const auto is_known = [&](std::size_t i) {
    return requests_[i].at_step <= world.step ||
           std::ranges::any_of(world.orders, [&](const core::Order& order) { return order.request == i + 1; });
  };
  while (next_ < requests_.size() && is_known(next_)) ++next_;
  while (next_ < requests_.size()) ask(lead);
}

/// Gives the next request. Its number is its place in the list, from 1.
void ImpatientClient::ask(node::Node& lead) {
  Request& request = requests_[next_++];
  for (std::size_t i = 0; i < request.actions.size(); ++i) {
    const bool is_last = i + 1 == request.actions.size();
    const core::Order& order = lead.order(request.actions[i], next_, is_last ? request.at_step : 0);
    if (is_last) request.at_step = order.at_step;
  }
}

Programs::Programs(const std::vector<Word>& words, VirtualCluster& listeners, core::Step from)
    : words_(words), listeners_(listeners), from_(from), next_(listeners.size(), 0) {
  if (!listeners.is_coupled()) return;
  // Coupled nodes learn of a static's move by an order.
  const core::Step ahead = 1 + listeners.node(0).protocol().round();
  for (Word& word : words_) word.said_step = std::min(word.said_step, word.setpoints.at_step - ahead);
  std::ranges::stable_sort(words_, {}, &Word::said_step);
}

void Programs::speak() {
  for (std::size_t r = 0; r < listeners_.size(); ++r) speak(listeners_.node(r), next_[r]);
}

void Programs::speak(node::Node& node, std::size_t& next) const {
  for (; next < words_.size(); ++next) {
    const Word& word = words_[next];
    if (word.said_step > node.current_step()) return;
    if (word.setpoints.at_step > from_) node.hear(word.setpoints);
  }
}

}  // namespace aurasim::lab
