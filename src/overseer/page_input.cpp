#include "overseer/page_input.h"

#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <stdexcept>

#include <fmt/format.h>

#include "core/limits.h"
#include "overseer/shape_json.h"

namespace aurasim::overseer {
namespace {

using Json = nlohmann::json;

Pause read_pause(const Json&) { return {}; }
Resume read_resume(const Json&) { return {}; }
Reset read_reset(const Json&) { return {}; }

StepOn read_step(const Json& json) {
  return {json.contains("count") ? whole_of(json.at("count"), "count", 1, 1'000'000) : 1};
}

SetRate read_rate(const Json& json) {
  const double value = number_of(field(json, "value"), "value");
  using namespace core::limits;
  if (!is_rate(value)) throw BadField(fmt::format("value is not from {} to {}", kSlowestRate, kFastestRate));
  return {value};
}

std::string file_name_in(const Json& json, const char* of_what) {
  const std::string name = text_of(field(json, "name"), "name", 100);
  if (name.empty() || name.find_first_of("/\\") != std::string::npos || name.front() == '.')
    throw BadField(fmt::format("name is not the name of a {}", of_what));
  return name;
}

LoadScene read_scene(const Json& json) { return {file_name_in(json, "scene")}; }
SaveWorld read_save(const Json& json) { return {file_name_in(json, "saved world")}; }
LoadWorld read_load(const Json& json) { return {file_name_in(json, "saved world")}; }

StepBack read_back(const Json&) { return {}; }

core::Rectangle read_box(const Json& json) {
  if (!json.is_array() || json.size() != 4) throw BadField("a box is not [x0, y0, x1, y1]");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto side = [&](std::size_t i, double outside) {
    return json[i].is_null() ? outside : number_of(json[i], "a side of a box");
  };
  const core::Rectangle box{side(0, -kInfinity), side(1, -kInfinity), side(2, kInfinity), side(3, kInfinity)};
  if (!(box.x0 < box.x1 && box.y0 < box.y1)) throw BadField("a box is inside out");
  return box;
}

SetRegions read_regions(const Json& json) {
  const Json& boxes = field(json, "boxes");
  if (!boxes.is_array() || boxes.empty() || boxes.size() > 1024) throw BadField("boxes is not a list of 1 to 1024");
  SetRegions regions;
  for (const Json& box : boxes) regions.boxes.push_back(read_box(box));
  return regions;
}

std::uint64_t read_hash(const Json& json) {
  const std::string text = text_of(json, "hash", 16);
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (text.size() != 16 || error != std::errc{} || end != text.data() + 16) throw BadField("hash is not 16 hex digits");
  return hash;
}

ShapeChoice read_shape_choice(const Json& json, bool for_body) {
  if (!json.is_object() || !json.contains("hash")) return read_shape(json);
  StoredShape stored;
  stored.hash = read_hash(json.at("hash"));
  if (!for_body) {
    only(json, {"hash"});
    return stored;
  }
  only(json, {"hash", "as"});
  const std::string as = text_of(field(json, "as"), "as", 20);
  if (as != "hull" && as != "decomposition") throw BadField("as is neither hull nor decomposition");
  stored.as = as == "hull" ? StoredShape::As::kHull : StoredShape::As::kDecomposition;
  return stored;
}

core::Vec3 vector_or_zero(const Json& json, const char* name) {
  return json.contains(name) ? vector_of(json.at(name), name) : core::Vec3::Zero();
}

Spawn read_spawn(const Json& json) {
  Spawn spawn;
  spawn.pose = pose_in(json);
  spawn.v_WB = vector_or_zero(json, "v");
  spawn.w_WB = vector_or_zero(json, "w");
  if (json.contains("prototype") == json.contains("shape")) throw BadField("needs either prototype or shape");
  if (json.contains("prototype")) {
    if (json.contains("mass_kg")) throw BadField("mass_kg does not go with prototype");
    spawn.kind = text_of(json.at("prototype"), "prototype", 256);
    return spawn;
  }
  const double mass_kg = number_of(field(json, "mass_kg"), "mass_kg");
  using namespace core::limits;
  if (!(mass_kg >= kLightest_kg && mass_kg <= kHeaviest_kg)) {
    throw BadField(fmt::format("mass_kg is not from {} to {}", kLightest_kg, kHeaviest_kg));
  }
  spawn.kind = NewKind{read_shape_choice(json.at("shape"), true), mass_kg};
  return spawn;
}

PlaceStatic read_static(const Json& json) { return {read_shape_choice(field(json, "shape"), false), pose_in(json)}; }

core::BodyId body_in(const Json& json) {
  return core::BodyId{static_cast<std::uint64_t>(whole_of(field(json, "body"), "body", 0, std::int64_t{1} << 53))};
}

Remove read_remove(const Json& json) {
  if (json.contains("body") == json.contains("static")) throw BadField("needs either body or static");
  if (json.contains("body")) return {body_in(json)};
  return {core::StaticId{static_cast<std::uint32_t>(whole_of(json.at("static"), "static", 0, 0xffff'ffff))}};
}

Impulse read_impulse(const Json& json) {
  Impulse impulse;
  impulse.body = body_in(json);
  impulse.J_W = vector_of(field(json, "J"), "J");
  if (json.contains("p")) impulse.p_W = vector_of(json.at("p"), "p");
  return impulse;
}

SetVelocity read_velocity(const Json& json) {
  SetVelocity velocity;
  velocity.body = body_in(json);
  velocity.v_WB = vector_of(field(json, "v"), "v");
  if (json.contains("w")) velocity.w_WB = vector_of(json.at("w"), "w");
  return velocity;
}

CastRay read_ray(const Json& json) {
  return {vector_of(field(json, "from"), "from"), vector_of(field(json, "to"), "to"), {}};
}

struct Reading {
  const char* kind;
  std::vector<const char*> fields;
  Command (*read)(const Json&);
};

template <auto read>
Command as_command(const Json& json) {
  return read(json);
}

const std::vector<Reading>& readings() {
  static const std::vector<Reading> kReadings = {
      {"pause", {}, as_command<read_pause>},
      {"resume", {}, as_command<read_resume>},
      {"reset", {}, as_command<read_reset>},
      {"step", {"count"}, as_command<read_step>},
      {"rate", {"value"}, as_command<read_rate>},
      {"scene", {"name"}, as_command<read_scene>},
      {"regions", {"boxes"}, as_command<read_regions>},
      {"spawn", {"prototype", "shape", "mass_kg", "p", "q", "v", "w"}, as_command<read_spawn>},
      {"static", {"shape", "p", "q"}, as_command<read_static>},
      {"remove", {"body", "static"}, as_command<read_remove>},
      {"impulse", {"body", "J", "p"}, as_command<read_impulse>},
      {"velocity", {"body", "v", "w"}, as_command<read_velocity>},
      {"ray", {"from", "to"}, as_command<read_ray>},
      {"save", {"name"}, as_command<read_save>},
      {"load", {"name"}, as_command<read_load>},
      {"back", {}, as_command<read_back>},
  };
  return kReadings;
}

Command read_command(const Json& json) {
  if (!json.is_object()) throw BadField("command is not an object");
  const std::string kind = text_of(field(json, "kind"), "kind", 20);
  for (const Reading& reading : readings()) {
    if (kind != reading.kind) continue;
    std::vector<const char*> fields = reading.fields;
    fields.push_back("kind");
    only(json, fields);
    return reading.read(json);
  }
  throw BadField(fmt::format("kind '{}' is unknown", kind));
}

bool flag_in(const Json& json, const char* name) {
  if (!json.contains(name)) return false;
  if (!json.at(name).is_boolean()) throw BadField(fmt::format("{} is neither true nor false", name));
  return json.at(name).get<bool>();
}

Show read_show(const Json& json) {
  only(json, {"type", "auras", "links", "contacts"});
  return {flag_in(json, "auras"), flag_in(json, "links"), flag_in(json, "contacts")};
}

double angle_in(const Json& json, const char* name) {
  const double angle_rad = number_of(field(json, name), name);
  if (!(angle_rad >= 0 && angle_rad <= 4)) throw BadField(fmt::format("{} is not from 0 to 4", name));
  return angle_rad;
}

View read_view(const Json& json) {
  only(json, {"type", "hidden", "eye", "towards", "half_angle", "pixel"});
  View view;
  view.hidden = flag_in(json, "hidden");
  if (!json.contains("eye")) return view;
  Eye eye;
  eye.p_W = vector_of(json.at("eye"), "eye");
  eye.towards_W = vector_of(field(json, "towards"), "towards");
  if (eye.towards_W.norm() < 1e-6) throw BadField("towards has no direction");
  eye.towards_W.normalize();
  eye.half_angle_rad = angle_in(json, "half_angle");
  eye.pixel_rad = angle_in(json, "pixel");
  view.eye = eye;
  return view;
}

Watch read_watch(const Json& json) {
  only(json, {"type", "slot"});
  const Json& slot = field(json, "slot");
  if (slot.is_null()) return {};
  return {static_cast<Slot>(whole_of(slot, "slot", 0, 0xffff'ffff))};
}

CommandMessage read_command_message(const Json& json) {
  only(json, {"type", "request", "command"});
  CommandMessage message;
  message.request = text_of(field(json, "request"), "request", 100);
  message.command = read_command(field(json, "command"));
  return message;
}

ReplayControl read_replay(const Json& json) {
  using Action = ReplayControl::Action;
  only(json, {"type", "action", "value"});
  const std::string action = text_of(field(json, "action"), "action", 20);
  if (action == "play") return {Action::kPlay, 0};
  if (action == "pause") return {Action::kPause, 0};
  if (action != "seek" && action != "speed") throw BadField(fmt::format("action '{}' is unknown", action));
  const double value = number_of(field(json, "value"), "value");
  if (action == "seek") return {Action::kSeek, value};
  if (!(value > 0 && value <= 100)) throw BadField("value is not above 0 and at most 100");
  return {Action::kSpeed, value};
}

PageMessage read_message(const Json& json) {
  if (!json.is_object()) throw BadField("the message is not an object");
  const std::string type = text_of(field(json, "type"), "type", 20);
  if (type == "show") return read_show(json);
  if (type == "view") return read_view(json);
  if (type == "watch") return read_watch(json);
  if (type == "command") return read_command_message(json);
  if (type == "replay") return read_replay(json);
  throw BadField(fmt::format("type '{}' is unknown", type));
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
  } catch (const BadField& bad) {
    return BadMessage{bad.what(), request_of(json)};
  }
}

}  // namespace aurasim::overseer
