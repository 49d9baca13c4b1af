// From JSON to an ask.
#include <algorithm>
#include <charconv>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "steering/ask_check.h"
#include "steering/json_fields.h"

namespace aurasim::steering {
namespace {

using Json = nlohmann::json;
using RunKind = messages::RunCommandKind;

template <class Kinds>
std::string names_of(const Kinds& kinds) {
  std::vector<std::string_view> names;
  for (const auto& kind : kinds) names.push_back(kind.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Reads the declared fields of one JSON object. Ranges are checked with the whole ask (problem_with).
class Fields {
 public:
  /// Refuses members that are not declared.
  Fields(const Json& of, std::string path, const std::vector<Field>& declared)
      : of_(of), path_(std::move(path)), declared_(declared) {
    for (const auto& [key, value] : of.items()) {
      const bool is_known = key == "kind" || std::ranges::find(declared, key, &Field::name) != declared.end();
      if (is_known || (key == at_field().name && path_.find('.') == std::string::npos)) continue;
      throw BadAsk(fmt::format("{}: unknown field {}; there are: {}", path_, shown(Json(key)),
                               declared.empty() ? "none" : names_of(declared)));
    }
  }

  const std::string& path() const { return path_; }
  bool has(std::string_view name) const { return of_.find(name) != of_.end(); }
  const Json& value(std::string_view name) const { return member(of_, name); }

  [[noreturn]] void refuse_field(const Field& field) const {
    refuse(fmt::format("{}.{}", path_, field.name), shown(value(field.name)), allowed(field));
  }
  [[noreturn]] void refuse_field(std::string_view name) const { refuse_field(declared(name)); }

  double number(std::string_view name, double absent) const {
    if (!needs(name)) return absent;
    if (!value(name).is_number()) refuse_field(name);
    return value(name).get<double>();
  }
  std::uint64_t whole(const Field& field, std::uint64_t absent) const {
    if (!has(field.name) && !field.absent.empty()) return absent;
    const Json& found = value(field.name);
    const bool is_whole = found.is_number_unsigned() || (found.is_number_integer() && found.get<std::int64_t>() >= 0);
    const auto number = is_whole ? static_cast<double>(found.get<std::uint64_t>()) : -1.0;
    if (!(number >= field.low && number <= field.high)) refuse_field(field);
    return found.get<std::uint64_t>();
  }
  std::uint64_t whole(std::string_view name, std::uint64_t absent = 0) const { return whole(declared(name), absent); }
  std::string text(std::string_view name) const {
    if (!value(name).is_string()) refuse_field(name);
    return value(name).get<std::string>();
  }
  core::Vec3 vector(std::string_view name) const {
    if (!needs(name)) return core::Vec3::Zero();
    const Json& v = value(name);
    if (!is_list(v, 3)) refuse_field(name);
    return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
  }
  std::optional<core::Vec3> optional_vector(std::string_view name) const {
    return has(name) ? std::optional(vector(name)) : std::nullopt;
  }
  core::Pose pose() const {
    core::Pose pose{vector("p"), core::Quat::Identity()};
    if (!has("q")) return pose;
    try {
      pose.q_WB = rotation_of(of_, "q");
    } catch (const BadAsk&) {
      refuse_field("q");
    }
    return pose;
  }

 private:
  const Field& declared(std::string_view name) const { return *std::ranges::find(declared_, name, &Field::name); }
  /// True if the field is there. Refuses its absence, if it is required.
  bool needs(std::string_view name) const {
    if (!has(name) && declared(name).absent.empty()) refuse_field(name);
    return has(name);
  }

  const Json& of_;
  std::string path_;
  const std::vector<Field>& declared_;
};

void check_alternatives(const AskKind& kind, const Fields& fields) {
  if (kind.first.empty()) return;
  if (fields.has(kind.first) == fields.has(kind.second)) {
    throw BadAsk(fmt::format("{}: found {} of {} and {}, allowed: one of them", kind.name,
                             fields.has(kind.first) ? "both" : "none", kind.first, kind.second));
  }
  if (!kind.of_second.empty() && fields.has(kind.first) && fields.has(kind.of_second)) {
    throw BadAsk(fmt::format("{0}.{1}: goes with {2} only: leave {1} or {3} out", kind.name, kind.of_second,
                             kind.second, kind.first));
  }
}

std::uint64_t hash_of(const Fields& fields) {
  const std::string text = fields.text("hash");
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (text.size() != 16 || error != std::errc{} || end != text.data() + 16) fields.refuse_field("hash");
  return hash;
}

core::MeshUse use_of(const Fields& fields, bool is_body) {
  if (!fields.has("as")) return is_body ? core::MeshUse::kHull : core::MeshUse::kTriangles;
  const Json& found = fields.value("as");
  if (!is_body || (found != "hull" && found != "decomposition")) fields.refuse_field("as");
  return found == "hull" ? core::MeshUse::kHull : core::MeshUse::kDecomposition;
}

core::MeshRef read_mesh(const Fields& fields, bool is_body, MeshFiles files, Ask& ask) {
  const core::MeshUse use = use_of(fields, is_body);
  if (fields.has("file") == fields.has("hash")) {
    throw BadAsk(fmt::format("{}: found {} of file and hash, allowed: one of them", fields.path(),
                             fields.has("file") ? "both" : "none"));
  }
  if (fields.has("hash")) return {hash_of(fields), use};
  if (files == MeshFiles::kRefused) {
    throw BadAsk(fields.path() + ".file: a page names a mesh by its hash: send the file to /api/shapes first");
  }
  ask.mesh_file = fields.text("file");
  if (const std::string why = problem_with(fields.path(), field_of("mesh", "file"), ask.mesh_file); !why.empty()) {
    throw BadAsk(why);
  }
  return {0, use};
}

core::ClientShape read_shape(const Fields& of_ask, MeshFiles files, Ask& ask) {
  const std::string path = of_ask.path() + ".shape";
  const Json& json = of_ask.value("shape");
  const Json& kind = member(json, "kind");
  const auto found = std::ranges::find_if(shapes(), [&](const ShapeKind& shape) { return kind == Json(shape.name); });
  if (!json.is_object()) refuse(path, shown(json), "a shape: " + names_of(shapes()));
  if (found == shapes().end()) refuse(path + ".kind", shown(kind), names_of(shapes()));
  const Fields fields(json, path, found->fields);
  if (found->name == "sphere") return core::Sphere{fields.number("radius", 0)};
  if (found->name == "box") return core::Box{fields.vector("size") / 2};
  if (found->name == "capsule") return core::Capsule{fields.number("radius", 0), fields.number("height", 0)};
  if (found->name == "cylinder") return core::Cylinder{fields.number("radius", 0), fields.number("height", 0)};
  return read_mesh(fields, of_ask.path() == "spawn", files, ask);
}

core::NewBody read_spawn(const Fields& fields, MeshFiles files, Ask& ask) {
  core::NewBody body;
  if (fields.has("prototype")) {
    body.prototype = fields.text("prototype");
  } else {
    body.shape = read_shape(fields, files, ask);
    body.mass_kg = fields.number("mass", 1);
  }
  body.pose = fields.pose();
  body.v_WB = fields.vector("v");
  body.w_WB = fields.vector("w");
  return body;
}

/// The static's id, or 0 and its name in `ask`.
core::StaticId read_static(const Fields& fields, Ask& ask) {
  const Json& found = fields.value("static");
  if (found.is_string() && !found.get_ref<const std::string&>().empty()) {
    ask.static_name = found.get<std::string>();
    return {};
  }
  if (found.is_string()) fields.refuse_field("static");
  return static_of(found, {}, fields.path() + ".static");
}

core::Repartition read_regions(const Fields& fields) {
  const Json& boxes = fields.value("boxes");
  if (!boxes.is_array() || boxes.size() > field_of("regions", "boxes").high) fields.refuse_field("boxes");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  core::Repartition regions;
  for (const Json& box : boxes) {
    const auto is_side = [](const Json& side) { return side.is_null() || side.is_number(); };
    if (!box.is_array() || box.size() != 4 || !std::ranges::all_of(box, is_side)) {
      refuse("regions.boxes", shown(box), allowed(field_of("regions", "boxes")));
    }
    const auto side = [&](std::size_t i, double outside) { return box[i].is_null() ? outside : box[i].get<double>(); };
    regions.boxes.push_back({side(0, -kInfinity), side(1, -kInfinity), side(2, kInfinity), side(3, kInfinity)});
  }
  return regions;
}

std::optional<RunKind> steering_of(std::string_view kind) {
  if (kind == "pause") return RunKind::kPause;
  if (kind == "resume") return RunKind::kResume;
  if (kind == "step") return RunKind::kStep;
  if (kind == "reset") return RunKind::kReset;
  if (kind == "stop") return RunKind::kStop;
  return std::nullopt;
}

/// An ask about bodies and statics. Nothing: it is of another kind.
std::optional<core::Ask> read_act(std::string_view kind, const Fields& fields, MeshFiles files, Ask& ask) {
  const auto body = [&] { return core::BodyId{fields.whole("body")}; };
  if (kind == "spawn") return read_spawn(fields, files, ask);
  if (kind == "static") {
    return core::NewStatic{read_shape(fields, files, ask), fields.pose()};
  }
  if (kind == "remove" && fields.has("body")) return core::RemoveBody{body()};
  if (kind == "remove") return core::RemoveStatic{read_static(fields, ask)};
  if (kind == "move") return core::SendStatic{read_static(fields, ask), fields.pose(), fields.number("seconds", 0)};
  if (kind == "impulse") return core::Impulse{body(), fields.vector("J"), fields.optional_vector("p")};
  if (kind == "velocity") return core::SetVelocity{body(), fields.vector("v"), fields.optional_vector("w")};
  if (kind == "ray") return core::Ray{fields.vector("from"), fields.vector("to"), {}};
  return std::nullopt;
}

/// An ask about the whole run, other than Steer and Drain.
core::Ask read_change(std::string_view kind, const Fields& fields) {
  if (kind == "rate") return core::SetRate{fields.number("value", 1)};
  if (kind == "scene") return core::ChangeScene{fields.text("name")};
  if (kind == "regions") return read_regions(fields);
  if (kind == "save") return core::Save{fields.text("name")};
  return core::Load{fields.text("name")};
}

}  // namespace

Ask read_ask(const Json& json, MeshFiles files) {
  if (!json.is_object()) refuse("ask", shown(json), "an object with the field kind");
  const Json& name = member(json, "kind");
  const auto kind = std::ranges::find_if(asks(), [&](const AskKind& ask) { return name == Json(ask.name); });
  if (kind == asks().end()) refuse("kind", shown(name), names_of(asks()));
  const Fields fields(json, std::string(kind->name), kind->fields);
  check_alternatives(*kind, fields);
  Ask ask;
  ask.at_step = static_cast<core::Step>(fields.whole(at_field(), 0));
  if (const auto steering = steering_of(kind->name)) {
    const bool is_step = *steering == RunKind::kStep;
    ask.what = Steer{*steering, is_step ? static_cast<std::int64_t>(fields.whole("count", 1)) : 1};
  } else if (kind->name == "drain") {
    ask.what = Drain{core::RegionId{static_cast<std::uint32_t>(fields.whole("region"))}};
  } else if (kind->name == "back") {
    ask.what = core::Ask(core::Load{});  // without a name: the newest earlier state
  } else {
    const std::optional<core::Ask> act = read_act(kind->name, fields, files, ask);
    core::Ask command = act ? *act : read_change(kind->name, fields);
    if (const std::string why = problem_with(command); !why.empty()) throw BadAsk(why);
    ask.what = std::move(command);
  }
  return ask;
}

void look_up_static(Ask& ask, const core::Scene& scene) {
  if (ask.static_name.empty()) return;
  core::Ask& command = std::get<core::Ask>(ask.what);
  auto* const move = std::get_if<core::SendStatic>(&command);
  const core::StaticId id = static_of(Json(ask.static_name), scene, move != nullptr ? "move.static" : "remove.static");
  (move != nullptr ? move->id : std::get<core::RemoveStatic>(command).id) = id;
  ask.static_name.clear();
}

}  // namespace aurasim::steering
