#include "overseer/page_input.h"

#include "steering/json_fields.h"

namespace aurasim::overseer {
namespace {

using Json = nlohmann::json;
using steering::BadAsk;
using steering::flag_of;
using steering::member;
using steering::number_of;
using steering::only;
using steering::refuse;
using steering::shown;
using steering::text_of;
using steering::whole_of;

constexpr double kFarthestEye = 1e7;  ///< m, and so for every number of a page

Show read_show(const Json& json) {
  only(json, {"type", "auras", "links", "contacts"});
  return {flag_of(json, "auras"), flag_of(json, "links"), flag_of(json, "contacts")};
}

core::Vec3 vector_in(const Json& json, const char* name) {
  const core::Vec3 v = steering::vector_of(json, name);
  if (!(v.cwiseAbs().maxCoeff() <= kFarthestEye)) refuse(name, shown(v), "numbers of at most 1e+07 either way");
  return v;
}

View read_view(const Json& json) {
  only(json, {"type", "hidden", "eye", "towards", "half_angle", "pixel"});
  View view;
  view.hidden = flag_of(json, "hidden");
  if (!json.contains("eye")) return view;
  Eye eye;
  eye.p_W = vector_in(json, "eye");
  eye.towards_W = vector_in(json, "towards");
  if (eye.towards_W.norm() < 1e-6) refuse("towards", shown(eye.towards_W), "a direction");
  eye.towards_W.normalize();
  eye.half_angle_rad = number_of(json, "half_angle", 0, 4);
  eye.pixel_rad = number_of(json, "pixel", 0, 4);
  view.eye = eye;
  return view;
}

Watch read_watch(const Json& json) {
  only(json, {"type", "slot"});
  if (json.contains("slot") && json.at("slot").is_null()) return {};
  return {static_cast<Slot>(whole_of(json, "slot", 0, 0xffff'ffff))};
}

CommandMessage read_command_message(const Json& json) {
  only(json, {"type", "request", "command"});
  CommandMessage message;
  message.request = text_of(json, "request", 100);
  message.ask = steering::read_ask(member(json, "command"), steering::MeshFiles::kRefused);
  return message;
}

ReplayControl read_replay(const Json& json) {
  using Action = ReplayControl::Action;
  only(json, {"type", "action", "value"});
  const std::string action = text_of(json, "action", 20);
  if (action == "play") return {Action::kPlay, 0};
  if (action == "pause") return {Action::kPause, 0};
  if (action == "seek") return {Action::kSeek, number_of(json, "value", -kFarthestEye, kFarthestEye)};
  if (action != "speed") refuse("action", shown(json.at("action")), "play, pause, seek or speed");
  const double speed = number_of(json, "value", 0, 100);
  if (speed == 0) refuse("value", "0", "more than 0, at most 100");
  return {Action::kSpeed, speed};
}

PageMessage read_message(const Json& json) {
  if (!json.is_object()) refuse("message", shown(json), "an object");
  const std::string type = text_of(json, "type", 20);
  if (type == "show") return read_show(json);
  if (type == "view") return read_view(json);
  if (type == "watch") return read_watch(json);
  if (type == "command") return read_command_message(json);
  if (type == "replay") return read_replay(json);
  refuse("type", shown(json.at("type")), "show, view, watch, command or replay");
}

std::string request_of(const Json& json) {
  if (!json.is_object() || !json.contains("request") || !json.at("request").is_string()) return {};
  const auto id = json.at("request").get<std::string>();
  return id.size() <= 100 ? id : std::string{};
}

}  // namespace

std::variant<PageMessage, BadMessage> read_page_message(std::string_view text) {
  if (text.size() > kLongestMessage) return BadMessage{"the message is too long", {}};
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return BadMessage{"the message is not JSON", {}};
  try {
    return read_message(json);
  } catch (const BadAsk& bad) {
    return BadMessage{bad.what(), request_of(json)};
  }
}

}  // namespace aurasim::overseer
