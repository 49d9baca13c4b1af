#include "agent/asks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "agent/problem.h"
#include "cut/saved_world.h"
#include "steering/client_mesh.h"

namespace aurasim::agent {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const char* key, const json& found, const char* allowed) {
  throw Problem(Kind::kRefused, fmt::format("{}: found {}, allowed: {}", key, found.dump(), allowed));
}

/// True for a list of `size` numbers. NaN and infinity arrive as null and are refused.
bool is_list(const json& found, std::size_t size) {
  return found.is_array() && found.size() == size &&
         std::all_of(found.begin(), found.end(), [](const json& number) { return number.is_number(); });
}

const json& member(const json& of, const char* key) {
  static const json none;
  const auto found = of.find(key);
  return found == of.end() ? none : *found;
}

double number_of(const json& of, const char* key) {
  const json& found = member(of, key);
  if (!found.is_number()) refuse(key, found, "a finite number");
  return found.get<double>();
}

std::uint64_t id_of(const json& of, const char* key) {
  const json& found = member(of, key);
  if (!found.is_number_unsigned()) refuse(key, found, "a whole number, from 0 on");
  return found.get<std::uint64_t>();
}

std::optional<core::Vec3> optional_vector(const json& of, const char* key) {
  return member(of, key).is_null() ? std::nullopt : std::optional(vector_of(of, key));
}

core::ClientShape shape_of(const json& of, bool is_body, steering::CommandClient& client) {
  const json& shape = member(of, "shape");
  if (!shape.is_object()) refuse("shape", shape, "a sphere, a box, a capsule or a mesh");
  if (shape.contains("mesh")) {
    const core::MeshUse of_body = shape.value("in_parts", false) ? core::MeshUse::kDecomposition : core::MeshUse::kHull;
    try {
      return steering::bring_mesh(shape.value("mesh", ""), is_body ? of_body : core::MeshUse::kTriangles, client);
    } catch (const steering::BadMesh& bad) {
      throw Problem(Kind::kRefused, bad.what());
    }
  }
  if (shape.contains("size")) return core::Box{vector_of(shape, "size") / 2};
  if (shape.contains("height")) return core::Capsule{number_of(shape, "radius"), number_of(shape, "height")};
  return core::Sphere{number_of(shape, "radius")};
}

core::NewBody body_of(const json& of, steering::CommandClient& client) {
  core::NewBody body;
  body.prototype = of.value("prototype", "");
  if (body.prototype.empty()) {
    body.shape = shape_of(of, true, client);
    body.mass_kg = number_of(of, "mass");
  }
  body.pose = pose_of(of);
  body.v_WB = vector_of(of, "v");
  body.w_WB = vector_of(of, "w");
  return body;
}

core::Repartition regions_of(const json& of) {
  core::Repartition regions;
  const auto side = [](const json& found, double beyond) {
    return found.is_number() ? found.get<double>() : std::copysign(std::numeric_limits<double>::infinity(), beyond);
  };
  for (const json& box : member(of, "boxes")) {
    if (!box.is_array() || box.size() != 4) refuse("boxes", box, "x0 y0 x1 y1 of each region");
    regions.boxes.push_back({side(box[0], -1), side(box[1], -1), side(box[2], 1), side(box[3], 1)});
  }
  return regions;
}

}  // namespace

core::Pose pose_of(const json& of) {
  const json& q = member(of, "q");
  if (!is_list(q, 4)) refuse("rotation", q, "a quaternion w x y z of finite numbers");
  const core::Quat rotation(q[0].get<double>(), q[1].get<double>(), q[2].get<double>(), q[3].get<double>());
  if (!(rotation.norm() > 1e-6 && rotation.norm() < 1e6)) refuse("rotation", q, "a quaternion w x y z, e.g. 1 0 0 0");
  return {vector_of(of, "p"), rotation.normalized()};
}

core::StaticId static_of(const json& of, const core::Scene& scene) {
  const json& found = member(of, "static");
  if (found.is_string()) {
    const auto named = core::find_static(scene, found.get<std::string>());
    if (!named) refuse("static", found, "the name or number of a static");
    return *named;
  }
  const std::uint64_t id = id_of(of, "static");
  if (id > std::numeric_limits<std::uint32_t>::max()) refuse("static", found, "the name or number of a static");
  return core::StaticId{static_cast<std::uint32_t>(id)};
}

core::Vec3 vector_of(const json& of, const char* key) {
  const json& v = member(of, key);
  if (!is_list(v, 3)) refuse(key, v, "three finite numbers");
  return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

std::string save_name_of(const json& of) {
  const json& found = member(of, "name");
  const std::string name = found.is_string() ? found.get<std::string>() : std::string();
  if (const std::string why = cut::refused_save_name(name); !why.empty()) throw Problem(Kind::kRefused, why);
  return name;
}

core::Ask ask_of(const json& of, const core::Scene& scene, steering::CommandClient& client) {
  const std::string kind = of.value("kind", "");
  if (kind == "spawn") return body_of(of, client);
  if (kind == "static") return core::NewStatic{shape_of(of, false, client), pose_of(of)};
  if (kind == "remove" && of.contains("static")) return core::RemoveStatic{static_of(of, scene)};
  if (kind == "move") return core::SendStatic{static_of(of, scene), pose_of(of), number_of(of, "duration")};
  if (kind == "remove") return core::RemoveBody{core::BodyId{id_of(of, "body")}};
  if (kind == "impulse") {
    return core::Impulse{core::BodyId{id_of(of, "body")}, vector_of(of, "J"), optional_vector(of, "p")};
  }
  if (kind == "velocity") {
    return core::SetVelocity{core::BodyId{id_of(of, "body")}, vector_of(of, "v"), optional_vector(of, "w")};
  }
  if (kind == "rate") return core::SetRate{number_of(of, "rate")};
  if (kind == "scene") return core::ChangeScene{of.value("name", "")};
  if (kind == "regions") return regions_of(of);
  if (kind == "load") return core::Load{save_name_of(of)};
  if (kind == "back") return core::Load{};
  throw Problem(Kind::kRefused, "no act is called '" + kind + "'");
}

}  // namespace aurasim::agent
